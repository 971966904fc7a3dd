//! The audited crates, and which file belongs to which.

use std::fs;
use std::path::Path;
use std::sync::LazyLock;

use anyhow::{Context, Result};

use crate::facts::facts;
use crate::shell;

/// A crate that is audited.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Crate {
    /// Folder from the workspace root, with forward slashes.
    pub folder: String,
    /// Name of the package.
    pub package: String,
}

static CRATES: LazyLock<Vec<Crate>> = LazyLock::new(|| {
    crates_below(&shell::root(), &facts().sources.audited).unwrap_or_else(|error| panic!("{error:#}"))
});

/// The audited crates, in the order of their folders.
pub fn crates() -> &'static [Crate] {
    &CRATES
}

/// Every crate at or below some folders.
pub fn crates_below(root: &Path, folders: &[String]) -> Result<Vec<Crate>> {
    let mut found = Vec::new();
    for folder in folders {
        collect_crates(root, folder, &mut found)?;
    }
    found.sort_by(|a, b| a.folder.cmp(&b.folder));
    Ok(found)
}

fn collect_crates(root: &Path, folder: &str, found: &mut Vec<Crate>) -> Result<()> {
    if let Ok(text) = fs::read_to_string(root.join(folder).join("Cargo.toml")) {
        let manifest: toml::Table = toml::from_str(&text).with_context(|| format!("{folder}/Cargo.toml"))?;
        let name = manifest.get("package").and_then(|package| package.get("name")?.as_str());
        let package = name.with_context(|| format!("{folder}/Cargo.toml names no package"))?.to_owned();
        found.push(Crate { folder: folder.to_owned(), package });
    }
    let entries = fs::read_dir(root.join(folder)).with_context(|| format!("cannot list {folder}"))?;
    for entry in entries.filter_map(Result::ok).filter(|entry| entry.path().is_dir()) {
        let name = entry.file_name().to_string_lossy().into_owned();
        if !["target", "src", "tests", "examples", "benches"].contains(&name.as_str()) {
            collect_crates(root, &format!("{folder}/{name}"), found)?;
        }
    }
    Ok(())
}

/// The folder of an audited package.
pub fn folder_of(package: &str) -> Result<&'static str> {
    let found = crates().iter().find(|one| one.package == package);
    Ok(&found.with_context(|| format!("{package} is no audited package"))?.folder)
}

/// How code names a package.
pub fn ident_of(package: &str) -> String {
    package.replace('-', "_")
}

/// The audited crate that holds a file, and the rest of the path behind its `src`.
pub fn within(file: &str) -> Option<(&'static Crate, &str)> {
    crates().iter().find_map(|one| {
        let rest = file.strip_prefix(&one.folder)?.strip_prefix("/src/")?;
        Some((one, rest))
    })
}

/// The file belongs to an audited crate.
pub fn is_own(file: &str) -> bool {
    within(file).is_some()
}

/// The top module that holds a file, as a path: the folder or the file behind `src`. Of a file elsewhere, its folder.
pub fn module_of(file: &str) -> String {
    match within(file) {
        Some((one, rest)) => {
            let top = rest.split('/').next().unwrap_or(rest).trim_end_matches(".rs");
            format!("{}/src/{top}", one.folder)
        }
        None => file.rsplit_once('/').map_or("", |(folder, _)| folder).to_owned(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn audited_crates_are_found_with_their_top_modules() {
        assert_eq!(folder_of("floorguard-guard").expect("it is audited"), "core-nostd/guard");
        assert!(folder_of("floorguard-sim").is_err() && crates().len() >= 8);
        assert!(is_own("drivers/src/lib.rs") && !is_own("drivers/build.rs") && !is_own("hal-sim/src/lib.rs"));
        assert_eq!(module_of("core-nostd/guard/src/decide.rs"), "core-nostd/guard/src/decide");
        assert_eq!(module_of("drivers/src/s300/receiver.rs"), "drivers/src/s300");
    }
}
