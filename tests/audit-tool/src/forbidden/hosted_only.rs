//! What of the audited crates is in no image: which modules, why, and that nothing which is compiled for a microcontroller
//! names them.

use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;

use anyhow::Result;
use syn::visit::{self, Visit};

use crate::claim::{Claim, Finding};
use crate::facts::{HostedOnly, facts};
use crate::sources;
use crate::sources::SourceFile;

/// The file belongs to something that runs on a Linux computer only.
pub fn is_hosted(file: &str) -> bool {
    let top = sources::module_of(file);
    let is_module = |module: &String| top.ends_with(&format!("/src/{module}"));
    sources::within(file).is_some_and(|(one, _)| {
        let entries = facts().hosted_only.iter().filter(|entry| entry.package == one.package);
        entries.into_iter().any(|entry| entry.modules.is_empty() || entry.modules.iter().any(is_module))
    })
}

/// How a reader names it.
pub fn shown(entry: &HostedOnly) -> String {
    match entry.modules.as_slice() {
        [] => entry.package.clone(),
        modules if entry.named_by.is_empty() => format!("{}::{{{}}}", entry.package, modules.join(", ")),
        modules => format!(
            "{}::{{{}}} (named by {}, in what no board calls)",
            entry.package,
            modules.join(", "),
            entry.named_by.join(", ")
        ),
    }
}

/// What code names of a crate that runs on a Linux computer only; no names: all of it.
type Names = BTreeMap<String, BTreeSet<String>>;

/// Reads what else goes into the images and judges all of it.
pub fn claim(root: &Path, audited: &[SourceFile]) -> Result<Claim> {
    let others = sources::read_folders(root, &facts().sources.firmware)?;
    Ok(judge(audited.iter().chain(&others), &names(audited)))
}

/// The modules, and what the root of their crate hands on of them.
fn names(audited: &[SourceFile]) -> Names {
    let mut names = Names::new();
    for entry in &facts().hosted_only {
        let own = names.entry(sources::ident_of(&entry.package)).or_default();
        own.extend(entry.modules.iter().cloned());
        let root = sources::folder_of(&entry.package).map(|folder| format!("{folder}/src/lib.rs"));
        let library = audited.iter().find(|file| root.as_ref().is_ok_and(|root| *root == file.path));
        for item in library.iter().flat_map(|file| &file.syntax.items) {
            let syn::Item::Use(item) = item else { continue };
            for path in sources::paths_of(&item.tree) {
                let path: Vec<&String> =
                    path.iter().filter(|name| !["crate", "self"].contains(&name.as_str())).collect();
                if let [module, .., name] = path.as_slice()
                    && entry.modules.contains(module)
                {
                    own.insert((*name).clone());
                }
            }
        }
    }
    names
}

fn judge<'a>(files: impl Iterator<Item = &'a SourceFile>, names: &Names) -> Claim {
    let mut findings = BTreeSet::new();
    let mut read = 0;
    for file in files.filter(|file| !is_hosted(&file.path)) {
        read += 1;
        let own_crate = sources::within(&file.path).map(|(one, _)| sources::ident_of(&one.package));
        let mut visitor = Visitor { file, own_crate, names, inside: vec![], findings: &mut findings };
        visitor.visit_file(&file.syntax);
    }
    Claim {
        id: "hosted-only-apart",
        text: "Nothing that is compiled for a microcontroller names what runs on a Linux computer only.",
        evidence: format!(
            "{read} files of core, drivers, runtime and both boards read; apart are: {}",
            facts().hosted_only.iter().map(shown).collect::<Vec<_>>().join(", ")
        ),
        findings: findings.into_iter().collect(),
    }
}

struct Visitor<'a> {
    file: &'a SourceFile,
    /// The crate that `crate` stands for.
    own_crate: Option<String>,
    names: &'a Names,
    /// Names of the `use` around it.
    inside: Vec<String>,
    findings: &'a mut BTreeSet<Finding>,
}

impl Visitor<'_> {
    /// The facts list this file as one that names the module: what stands on it is generic, and no board asks for it.
    fn may_name(&self, krate: &str, name: &str) -> bool {
        let mut entries =
            facts().hosted_only.iter().filter(|entry| sources::ident_of(&entry.package) == krate);
        entries.any(|entry| {
            entry.modules.iter().any(|module| module == name) && entry.named_by.contains(&self.file.path)
        })
    }

    fn named(&mut self, path: &[String], line: usize) {
        let Some((first, rest)) = path.split_first() else { return };
        let krate = self.own_crate.as_ref().filter(|_| first == "crate").unwrap_or(first);
        let Some(apart) = self.names.get(krate) else { return };
        let shown = match rest.first() {
            _ if apart.is_empty() => krate.clone(),
            Some(name) if apart.contains(name) && !self.may_name(krate, name) => format!("{krate}::{name}"),
            _ => return,
        };
        let message = format!("names `{shown}`, which is in no safety image");
        self.findings.insert(Finding { place: self.file.path.clone(), line, message });
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
        let library = "mod range_model;\npub use range_model::RangeModel;";
        let library =
            sources::parse("core-nostd/localisation/src/lib.rs", library.to_owned()).expect("it parses");
        let claim = judge(std::iter::once(&file), &names(&[library]));
        claim.findings.iter().map(|finding| finding.line).collect()
    }

    #[test]
    fn a_hosted_module_in_an_image_is_named() {
        let in_runtime = |text: &str| lines("runtime/src/a.rs", text);
        assert_eq!(in_runtime("use core::fmt;\nuse floorguard_mapping::Grid;"), [2]);
        assert_eq!(
            in_runtime("use floorguard_perception::{people::Pipeline,\n rgbd_people::Detector};"),
            [2]
        );
        assert_eq!(in_runtime("use floorguard_perception::{people,\n online_learning};"), [2]);
        assert_eq!(in_runtime("use floorguard_localisation::{odometry,\n RangeModel};"), [2]);
        assert_eq!(in_runtime("fn f() {\n floorguard_cleaning::plan();\n}"), [2]);
        assert_eq!(in_runtime("use crate::online_learning::Map;"), [0; 0]);
        assert_eq!(in_runtime("use floorguard_perception::people::Pipeline;"), [0; 0]);
        let learn = "fn f() {\n crate::online_learning::learn();\n}";
        assert_eq!(lines("core-nostd/perception/src/people/a.rs", learn), [2]);
        assert_eq!(lines("core-nostd/types/src/a.rs", learn), [0; 0]);
        assert_eq!(lines("core-nostd/cleaning/src/a.rs", "use floorguard_mapping::Grid;"), [0; 0]);
    }
}
