//! How long files and modules are.

use std::collections::BTreeMap;
use std::path::Path;

use anyhow::{Context, Result};

/// Lines by path, tests included.
pub type Lines = BTreeMap<String, usize>;

/// Every Rust file below some folders.
pub fn files(root: &Path, folders: &[String]) -> Result<Lines> {
    let mut lines = Lines::new();
    for folder in folders {
        collect(root, &root.join(folder), &mut lines)?;
    }
    Ok(lines)
}

fn collect(root: &Path, folder: &Path, lines: &mut Lines) -> Result<()> {
    let entries = std::fs::read_dir(folder).with_context(|| format!("cannot list {}", folder.display()))?;
    for entry in entries {
        let path = entry?.path();
        if path.is_dir() && path.file_name().is_none_or(|name| name != "target") {
            collect(root, &path, lines)?;
        } else if path.extension().is_some_and(|extension| extension == "rs") {
            let text =
                std::fs::read_to_string(&path).with_context(|| format!("cannot read {}", path.display()))?;
            let name = path.strip_prefix(root).unwrap_or(&path).to_string_lossy().replace('\\', "/");
            lines.insert(name, text.lines().count());
        }
    }
    Ok(())
}

/// Lines of each top module, by the folder of the crate's sources and the module's name.
pub fn modules(files: &Lines, folders: &[String]) -> Lines {
    let mut modules = Lines::new();
    for (file, lines) in files {
        let holder = folders.iter().filter(|folder| file.starts_with(&format!("{folder}/src/")));
        if let Some(folder) = holder.max_by_key(|folder| folder.len()) {
            let rest = file.get(folder.len() + "/src/".len()..).unwrap_or_default();
            let top = rest.split('/').next().unwrap_or(rest).trim_end_matches(".rs");
            *modules.entry(format!("{folder}/src/{top}")).or_default() += lines;
        }
    }
    modules
}

/// The length that as many files stay below as exceed it.
pub fn median(files: &Lines) -> usize {
    let mut lengths: Vec<usize> = files.values().copied().collect();
    lengths.sort_unstable();
    lengths.get(lengths.len() / 2).copied().unwrap_or(0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_of_modules_are_those_of_their_files() {
        let files =
            [("a/src/x/mod.rs", 3), ("a/src/x/y.rs", 4), ("a/src/z.rs", 5), ("a/b/src/x.rs", 6), ("c.rs", 9)];
        let files: Lines = files.into_iter().map(|(name, lines)| (name.to_owned(), lines)).collect();
        let modules = modules(&files, &["a".to_owned(), "a/b".to_owned()]);
        let shown: Vec<_> = modules.iter().map(|(name, lines)| (name.as_str(), *lines)).collect();
        assert_eq!(shown, [("a/b/src/x", 6), ("a/src/x", 7), ("a/src/z", 5)]);
        assert_eq!(median(&files), 5);
    }
}
