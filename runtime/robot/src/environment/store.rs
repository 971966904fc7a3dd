//! Keeps a model across power cycles: whenever the power goes, at most the newest save is lost.
//!
//! A save is written beside the file, brought to the disk, and only then put in its place; the one before is kept as
//! `.old`. Whatever a cut leaves, one of the three is whole, and the newest whole one is read.

use std::fs::File;
use std::io::Write as _;
use std::path::{Path, PathBuf};

use anyhow::{Context, bail};

use super::codec::{decode, encode};
use super::model::Model;

/// A model that was read.
pub struct Loaded {
    /// The model.
    pub model: Model,
    /// What was wrong with files that were passed over.
    pub passed_over: Vec<String>,
}

fn beside(path: &Path, suffix: &str) -> PathBuf {
    let mut name = path.as_os_str().to_owned();
    name.push(suffix);
    PathBuf::from(name)
}

/// Saves a model and counts its generation: it is newer than all that is there.
///
/// # Errors
/// The disk is full, or the folder cannot be written; the model on the disk stays what it was.
pub fn save(path: &Path, model: &mut Model) -> anyhow::Result<()> {
    let there = load(path).ok().flatten().map_or(0, |loaded| loaded.model.generation);
    model.generation = model.generation.max(there).saturating_add(1);
    replace_file(path, &encode(model)?)
}

/// Puts bytes in the place of a file; the one before is kept as `.old`.
///
/// # Errors
/// The disk is full, or the folder cannot be written; what was there stays.
pub fn replace_file(path: &Path, bytes: &[u8]) -> anyhow::Result<()> {
    let (new, old) = (beside(path, ".new"), beside(path, ".old"));
    let fail = |what: &str| format!("{}: cannot be {what}", path.display());
    let mut file = File::create(&new).with_context(|| fail("written"))?;
    file.write_all(bytes).and_then(|()| file.sync_all()).with_context(|| fail("written"))?;
    drop(file);
    if path.exists() {
        std::fs::rename(path, &old).with_context(|| fail("put aside"))?;
    }
    std::fs::rename(&new, path).with_context(|| fail("put in place"))?;
    let folder = path.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."));
    // The names, too, must reach the disk. Some file systems cannot do that for folders.
    let _ = File::open(folder).and_then(|folder| folder.sync_all());
    Ok(())
}

/// The names under which a cut may have left a file, the likeliest first.
pub fn places(path: &Path) -> [PathBuf; 3] {
    [path.to_owned(), beside(path, ".new"), beside(path, ".old")]
}

/// The newest whole one of a file's versions, as [`replace_file`] left them.
pub fn read_newest<T>(path: &Path, decode: impl Fn(&[u8]) -> anyhow::Result<T>) -> Option<T> {
    let versions = [beside(path, ".new"), path.to_owned(), beside(path, ".old")];
    versions.iter().find_map(|version| decode(&std::fs::read(version).ok()?).ok())
}

/// Reads the newest whole model. `None` if there has never been one.
///
/// # Errors
/// There are files, but none is whole.
pub fn load(path: &Path) -> anyhow::Result<Option<Loaded>> {
    let mut best: Option<Model> = None;
    let mut passed_over = Vec::new();
    for candidate in places(path) {
        let bytes = match std::fs::read(&candidate) {
            Ok(bytes) => bytes,
            Err(error) if error.kind() == std::io::ErrorKind::NotFound => continue,
            Err(error) => {
                passed_over.push(format!("{}: cannot be read ({error})", candidate.display()));
                continue;
            }
        };
        match decode(&bytes) {
            Ok(model) if best.as_ref().is_none_or(|best| model.generation > best.generation) => {
                best = Some(model)
            }
            Ok(_) => {}
            Err(error) => passed_over.push(format!("{}: {error:#}", candidate.display())),
        }
    }
    match best {
        Some(model) => Ok(Some(Loaded { model, passed_over })),
        None if passed_over.is_empty() => Ok(None),
        None => bail!("{}", passed_over.join("; ")),
    }
}

#[cfg(test)]
#[path = "store_tests.rs"]
mod tests;
