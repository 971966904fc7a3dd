//! A copy of the tree in which the loops count.

use std::collections::BTreeSet;
use std::fs;
use std::path::PathBuf;

use anyhow::Result;

use crate::copied_tree;
use crate::facts::facts;
use crate::loops::LoopSite;
use crate::loops::rewrite::{BOUND, MODULE, SITE};
use crate::sources::SourceFile;

const COUNTER: &str = include_str!("counter.rs.in");

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
        Ok(Self { folder: copied_tree::copy("loops")? })
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
                text += &imports();
            }
            self.write(&file.path, &text)?;
        }
        let counter = COUNTER.replace("ENVIRONMENT", &facts().environment);
        let counter = format!("{counter}\nconst SITES: usize = {};\n", sites.len());
        copied_tree::add_module(&self.sources(), MODULE, &counter)
    }

    fn write(&self, path: &str, text: &str) -> Result<()> {
        copied_tree::write(&self.sources().join(path), text)
    }
}

/// What a file with counters needs in sight.
fn imports() -> String {
    let counters = copied_tree::path_of(MODULE);
    format!(
        "\n#[allow(unused_imports)]\nuse {counters}::{{CountItems as _, Unknown as _, WalkItems as _}};\n"
    )
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn uncompilable_bound_is_left_out() {
        let text = format!("f({SITE}, {BOUND}N as u64{BOUND});");
        assert_eq!(written(&text, 7, true), "f(7, N as u64);");
        assert_eq!(written(&text, 7, false), "f(7, 0);");
        assert_eq!(written(".turn()", 7, false), ".turn()");
    }
}
