//! The rooms of the core that are in no safety image: which, why, and that nothing which is linked there names them.

use std::collections::BTreeSet;
use std::path::Path;

use anyhow::Result;
use syn::visit::{self, Visit};

use super::claim::{Claim, Finding};
use super::sources::{self, SourceFile};

/// A room that runs on a Linux computer only, and why the microcontroller has no need of it.
pub struct HostedRoom {
    /// Name of the module of the core.
    pub name: &'static str,
    /// Why it is in no image.
    pub reason: &'static str,
}

/// The rooms.
pub const HOSTED_ROOMS: &[HostedRoom] = &[
    HostedRoom {
        name: "cleaning",
        reason: "Plans where to clean, over maps of a whole building: memory that a microcontroller lacks. Its commands are \
                 wishes; the guard permits or refuses each.",
    },
    HostedRoom {
        name: "maps",
        reason: "Keeps what was learnt of a building in files between missions. Nothing of it reaches the guard.",
    },
    HostedRoom {
        name: "online_learning",
        reason: "Proposes another classifier after minutes of driving; the shipped one stays in use. Its sums over all looks \
                 need the memory of a computer.",
    },
    HostedRoom {
        name: "rgbd_people",
        reason: "Finds people in depth pictures, for which the microcontroller has neither camera nor room. People that it \
                 finds can only tighten what the guard permits (FG-REQ-030).",
    },
];

/// The room, as a folder, is one of them.
pub fn is_hosted(folder: &str) -> bool {
    folder.strip_prefix("core-nostd/src/").is_some_and(is_room)
}

fn is_room(name: &str) -> bool {
    HOSTED_ROOMS.iter().any(|room| room.name == name)
}

/// What is compiled into an image besides the audited layers, from the workspace root.
const IMAGE_SOURCES: &[&str] =
    &["runtime/src", "runtime/configuration/src", "runtime/boards/mps2-an500", "runtime/boards/stm32h743"];

/// Reads what else goes into the images and judges all of it.
pub fn claim(root: &Path, layers: &[SourceFile]) -> Result<Claim> {
    let others = sources::read_folders(root, IMAGE_SOURCES)?;
    Ok(judge(layers.iter().chain(&others)))
}

fn judge<'a>(files: impl Iterator<Item = &'a SourceFile>) -> Claim {
    let mut findings = BTreeSet::new();
    let mut read = 0;
    for file in files.filter(|file| !HOSTED_ROOMS.iter().any(|room| is_within(&file.path, room.name))) {
        read += 1;
        let mut visitor = Visitor { file, inside: vec![], findings: &mut findings };
        visitor.visit_file(&file.syntax);
    }
    Claim {
        id: "hosted-rooms-apart",
        text: "Nothing that is compiled for a microcontroller names a room that runs on a Linux computer only.",
        evidence: format!(
            "{read} files of core, drivers, runtime and both boards read; apart are: {}",
            HOSTED_ROOMS.iter().map(|room| room.name).collect::<Vec<_>>().join(", ")
        ),
        findings: findings.into_iter().collect(),
    }
}

fn is_within(path: &str, room: &str) -> bool {
    path.strip_prefix("core-nostd/src/").is_some_and(|rest| rest.split('/').next() == Some(room))
}

struct Visitor<'a> {
    file: &'a SourceFile,
    /// Names of the `use` around it.
    inside: Vec<String>,
    findings: &'a mut BTreeSet<Finding>,
}

impl Visitor<'_> {
    fn named(&mut self, names: &[String], line: usize) {
        let core = self.file.path.starts_with("core-nostd/");
        let [krate, room, ..] = names else { return };
        if (krate == "floorguard_core" || core && krate == "crate") && is_room(room) {
            let message = format!("names the room `{room}`, which is in no safety image");
            self.findings.insert(Finding { place: self.file.path.clone(), line, message });
        }
    }
}

impl<'ast> Visit<'ast> for Visitor<'_> {
    fn visit_use_path(&mut self, import: &'ast syn::UsePath) {
        self.inside.push(import.ident.to_string());
        self.named(&self.inside.clone(), import.ident.span().start().line);
        visit::visit_use_path(self, import);
        self.inside.pop();
    }

    fn visit_use_name(&mut self, import: &'ast syn::UseName) {
        let mut names = self.inside.clone();
        names.push(import.ident.to_string());
        self.named(&names, import.ident.span().start().line);
    }

    fn visit_path(&mut self, path: &'ast syn::Path) {
        let names: Vec<String> = path.segments.iter().map(|part| part.ident.to_string()).collect();
        if let Some(first) = path.segments.first() {
            self.named(&names, first.ident.span().start().line);
        }
        visit::visit_path(self, path);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn lines(path: &str, text: &str) -> Vec<usize> {
        let file = sources::parse(path, text.to_owned()).expect("it parses");
        judge(std::iter::once(&file)).findings.iter().map(|finding| finding.line).collect()
    }

    #[test]
    fn a_hosted_room_in_an_image_is_named() {
        assert_eq!(lines("runtime/src/a.rs", "use core::fmt;\nuse floorguard_mapping::Map;"), [2]);
        assert_eq!(
            lines("runtime/src/a.rs", "use floorguard_core::{guard::Supervisor,\n cleaning::Plan};"),
            [2]
        );
        assert_eq!(lines("runtime/src/a.rs", "use floorguard_core::{time,\n cleaning};"), [2]);
        assert_eq!(lines("core-nostd/src/guard/a.rs", "fn f() {\n crate::online_learning::learn();\n}"), [2]);
        assert_eq!(lines("runtime/src/a.rs", "use crate::maps::Map;"), [0; 0]);
        assert_eq!(lines("core-nostd/src/cleaning/a.rs", "use crate::maps::Map;"), [0; 0]);
    }
}
