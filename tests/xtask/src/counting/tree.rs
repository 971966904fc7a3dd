//! A copy of the tree in which the loops count.

use std::collections::BTreeSet;
use std::fs;
use std::path::{Path, PathBuf};

use anyhow::{Context, Result};

use super::rewrite::{BOUND, SITE};
use crate::audit::{LoopSite, SourceFile};
use crate::shell;

const COUNTER: &str = include_str!("counter.rs.in");
const IMPORTS: &str = "\n#[allow(unused_imports)]\nuse ::floorguard_core::loop_counts::{CountItems as _, Unknown as _, WalkItems as _};\n";

/// What the compiler refuses of the counters: bounds that are no number there, then whole counters.
#[derive(Default)]
pub struct Refused {
    /// Loops whose bound is left out.
    pub bounds: BTreeSet<usize>,
    /// Loops that are not counted.
    pub loops: BTreeSet<usize>,
}

/// The folder `target/loops`: the copy, what it is built into, what it counts.
pub struct Tree {
    /// All of it.
    pub folder: PathBuf,
}

impl Tree {
    /// Copies what the build needs. What was built before stays.
    pub fn copy() -> Result<Self> {
        let tree = Self { folder: shell::target_folder().join("loops") };
        let root = shell::root();
        if tree.sources().exists() {
            fs::remove_dir_all(tree.sources())?;
        }
        copy(&root, &tree.sources()).context("cannot copy the sources")?;
        // The recordings lie beside the workspace; tests look for them there.
        #[cfg(unix)]
        if let Some(shared) = root.parent().map(|parent| parent.join("shared"))
            && shared.is_dir()
            && !tree.folder.join("shared").exists()
        {
            std::os::unix::fs::symlink(shared, tree.folder.join("shared"))?;
        }
        Ok(tree)
    }

    /// The copy of the workspace.
    pub fn sources(&self) -> PathBuf {
        self.folder.join("tree")
    }

    /// The folder of the counts, without those of another run.
    pub fn empty_counts(&self) -> Result<PathBuf> {
        let counts = self.folder.join("counts");
        if counts.exists() {
            fs::remove_dir_all(&counts)?;
        }
        fs::create_dir_all(&counts)?;
        Ok(counts)
    }

    /// Writes the counters into the copy.
    pub fn instrument(&self, files: &[SourceFile], sites: &[LoopSite], refused: &Refused) -> Result<()> {
        for file in files {
            let numbered = sites
                .iter()
                .enumerate()
                .filter(|(number, site)| site.file == file.path && !refused.loops.contains(number));
            let mut edits: Vec<(usize, String)> = numbered
                .flat_map(|(number, site)| {
                    let bound = !refused.bounds.contains(&number);
                    site.edits.iter().map(move |edit| (edit.at, written(&edit.text, number, bound)))
                })
                .collect();
            edits.sort_by_key(|(at, _)| *at);
            let mut text = file.text.clone();
            for (at, addition) in edits.iter().rev() {
                text.insert_str(*at, addition);
            }
            if !edits.is_empty() {
                text.push_str(IMPORTS);
            }
            self.write(&file.path, &text)?;
        }
        self.write(
            "core-nostd/src/loop_counts.rs",
            &format!("{COUNTER}\nconst SITES: usize = {};\n", sites.len()),
        )?;
        let library = fs::read_to_string(shell::root().join("core-nostd/src/lib.rs"))?;
        let library = library.replace("#[cfg(test)]\nextern crate std;", "extern crate std;");
        let module = "\nextern crate self as floorguard_core;\npub mod loop_counts;\n";
        let std = if library.contains("extern crate std;") { "" } else { "extern crate std;\n" };
        self.write("core-nostd/src/lib.rs", &format!("{library}{module}{std}"))
    }

    fn write(&self, path: &str, text: &str) -> Result<()> {
        let path = self.sources().join(path);
        if fs::read_to_string(&path).is_ok_and(|before| before == text) {
            return Ok(());
        }
        fs::write(&path, text).with_context(|| format!("cannot write {}", path.display()))
    }
}

fn written(text: &str, number: usize, with_bound: bool) -> String {
    let text = text.replace(SITE, &number.to_string());
    let mut parts = text.split(BOUND);
    match (parts.next(), parts.next(), parts.next()) {
        (Some(before), Some(bound), Some(after)) => {
            format!("{before}{}{after}", if with_bound { bound } else { "0" })
        }
        _ => text,
    }
}

fn copy(from: &Path, to: &Path) -> Result<()> {
    fs::create_dir_all(to)?;
    for entry in fs::read_dir(from)? {
        let entry = entry?;
        let name = entry.file_name();
        if name == "target" || name == ".git" {
            continue;
        }
        let kind = entry.file_type()?;
        if kind.is_dir() {
            copy(&entry.path(), &to.join(&name))?;
        } else if kind.is_file() {
            fs::copy(entry.path(), to.join(&name))?;
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_bound_that_does_not_compile_is_left_out() {
        let text = format!("f({SITE}, {BOUND}N as u64{BOUND});");
        assert_eq!(written(&text, 7, true), "f(7, N as u64);");
        assert_eq!(written(&text, 7, false), "f(7, 0);");
        assert_eq!(written(".turn()", 7, false), ".turn()");
    }
}
