//! A copy of the workspace under the target folder, to be changed and built there.

use std::fs;
use std::path::{Path, PathBuf};

use anyhow::{Context, Result};

use crate::shell;

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

/// The core's library with one more module, which needs the standard library.
pub fn library_with(module: &str) -> Result<String> {
    let library = fs::read_to_string(shell::root().join("core-nostd/src/lib.rs"))?;
    let library = library.replace("#[cfg(test)]\nextern crate std;", "extern crate std;");
    let std = if library.contains("extern crate std;") { "" } else { "extern crate std;\n" };
    Ok(format!("{library}\nextern crate self as floorguard_core;\npub mod {module};\n{std}"))
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
