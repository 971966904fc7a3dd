//! A copy of the workspace under the target folder, to be changed and built there.

use std::fs;
use std::path::{Path, PathBuf};

use anyhow::{Context, Result};

use crate::facts::facts;
use crate::{shell, sources};

/// Copies what the build needs into `NAME/tree` under the target folder and tells that folder. What was built there before
/// stays.
pub fn copy(name: &str) -> Result<PathBuf> {
    let folder = shell::target_folder().join(name);
    let root = shell::root();
    let sources = folder.join("tree");
    if sources.exists() {
        fs::remove_dir_all(&sources)?;
    }
    copy_folder(&root, &sources).context("cannot copy the sources")?;
    // The recordings lie beside the workspace; tests look for them there.
    #[cfg(unix)]
    if let Some(shared) = root.parent().map(|parent| parent.join("shared"))
        && shared.is_dir()
        && !folder.join("shared").exists()
    {
        std::os::unix::fs::symlink(shared, folder.join("shared"))?;
    }
    Ok(folder)
}

/// Writes a file unless it says that already: what is not written is not compiled again.
pub fn write(path: &Path, text: &str) -> Result<()> {
    if fs::read_to_string(path).is_ok_and(|before| before == text) {
        return Ok(());
    }
    fs::write(path, text).with_context(|| format!("cannot write {}", path.display()))
}

/// Adds a module to the crate that every audited crate knows. It needs the standard library, which that crate then has.
pub fn add_module(tree: &Path, module: &str, text: &str) -> Result<()> {
    let folder = sources::folder_of(&facts().sources.helpers)?;
    let library = format!("{folder}/src/lib.rs");
    let before = fs::read_to_string(shell::root().join(&library)).with_context(|| library.clone())?;
    write(&tree.join(&library), &library_with(&before, module))?;
    write(&tree.join(format!("{folder}/src/{module}.rs")), text)
}

fn library_with(library: &str, module: &str) -> String {
    let own_name = sources::ident_of(&facts().sources.helpers);
    let library = library.replace("#[cfg(test)]\nextern crate std;", "extern crate std;");
    let std = if library.contains("extern crate std;") { "" } else { "extern crate std;\n" };
    format!("{library}\nextern crate self as {own_name};\npub mod {module};\n{std}")
}

/// How the audited crates name a module that was added.
pub fn path_of(module: &str) -> String {
    format!("::{}::{module}", sources::ident_of(&facts().sources.helpers))
}

fn copy_folder(from: &Path, to: &Path) -> Result<()> {
    fs::create_dir_all(to)?;
    for entry in fs::read_dir(from)? {
        let entry = entry?;
        let name = entry.file_name();
        if name == "target" || name == ".git" {
            continue;
        }
        let kind = entry.file_type()?;
        if kind.is_dir() {
            copy_folder(&entry.path(), &to.join(&name))?;
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
    fn added_module_has_one_name_everywhere() {
        let library = library_with("#![no_std]\n#[cfg(test)]\nextern crate std;\npub mod a;\n", "extra");
        assert_eq!(library.matches("extern crate std;").count(), 1, "{library}");
        let own_name = path_of("extra").split("::").nth(1).map(str::to_owned).expect("a crate");
        assert!(library.contains(&format!("extern crate self as {own_name};\npub mod extra;")), "{library}");
    }
}
