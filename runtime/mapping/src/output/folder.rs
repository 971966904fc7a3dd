//! A folder of files that is there as a whole or not at all: written beside its place, forced to the disk, and put in its
//! place in one step. Whenever the power fails, the place holds the former folder or the new one.

use std::borrow::Borrow;
use std::fs::{self, File};
use std::io::{self, Write as _};
use std::path::{Path, PathBuf};

use rustix::fs::{CWD, RenameFlags, renameat_with};

use super::files::OutputFile;

/// This file marks a folder as ours: a folder with files but without it is never replaced.
pub const MARKER: &str = "map.yaml";

/// The same of a map in space.
pub const MARKER_3D: &str = "map3d.json";

/// Why a folder was not written. The former one is untouched.
#[derive(Debug, thiserror::Error)]
pub enum ReplaceError {
    /// It holds files, and is no map: they would be lost.
    #[error(
        "{0}: this folder holds files and no map; give another folder, which is made, or that of a former map"
    )]
    Foreign(PathBuf),
    /// The place is a file, or has no name.
    #[error("{0}: no folder can be made here")]
    NoPlace(PathBuf),
    /// The system refuses.
    #[error("{path}: cannot be written ({cause})")]
    Write {
        /// Which file or folder.
        path: PathBuf,
        /// What the system says.
        cause: io::Error,
    },
}

/// Whether a folder can take a map: it is not there, empty, or holds a former map.
///
/// # Errors
/// It holds other files, or is a file.
pub fn check_place(folder: &Path) -> Result<(), ReplaceError> {
    if folder.is_file() || folder.file_name().is_none() {
        return Err(ReplaceError::NoPlace(folder.to_owned()));
    }
    let is_empty = fs::read_dir(folder).map_or(true, |mut entries| entries.next().is_none());
    if is_empty || [MARKER, MARKER_3D].iter().any(|marker| folder.join(marker).is_file()) {
        Ok(())
    } else {
        Err(ReplaceError::Foreign(folder.to_owned()))
    }
}

/// Puts the files into a folder in place of all that was in it. The folder beside it in which they are prepared is named
/// `.NAME.new`; one that was left by a cut is removed first.
///
/// # Errors
/// See [`ReplaceError`]; in each case the former folder is as it was.
pub fn replace_folder(
    folder: &Path,
    files: impl IntoIterator<Item = impl Borrow<OutputFile>>,
) -> Result<(), ReplaceError> {
    check_place(folder)?;
    let name = folder.file_name().ok_or_else(|| ReplaceError::NoPlace(folder.to_owned()))?;
    let parent = folder.parent().filter(|parent| !parent.as_os_str().is_empty()).unwrap_or(Path::new("."));
    let beside = parent.join(format!(".{}.new", name.to_string_lossy()));
    let failed = |path: &Path| {
        let path = path.to_owned();
        move |cause| ReplaceError::Write { path, cause }
    };
    fs::create_dir_all(parent).map_err(failed(parent))?;
    if beside.exists() {
        fs::remove_dir_all(&beside).map_err(failed(&beside))?;
    }
    let written = write_all(&beside, files).and_then(|()| {
        exchange(&beside, folder).map_err(failed(folder))?;
        sync(parent).map_err(failed(parent))
    });
    // Now the former folder, or what could not be finished; a rest does no harm and goes the next time.
    let _ = fs::remove_dir_all(&beside);
    written
}

fn write_all(
    folder: &Path,
    files: impl IntoIterator<Item = impl Borrow<OutputFile>>,
) -> Result<(), ReplaceError> {
    let mut folders = vec![folder.to_owned()];
    fs::create_dir(folder).map_err(|cause| ReplaceError::Write { path: folder.to_owned(), cause })?;
    for file in files {
        let file = file.borrow();
        let path = folder.join(&file.name);
        write_one(&path, &file.bytes, &mut folders)
            .map_err(|cause| ReplaceError::Write { path: path.clone(), cause })?;
    }
    for folder in folders {
        sync(&folder).map_err(|cause| ReplaceError::Write { path: folder.clone(), cause })?;
    }
    Ok(())
}

fn write_one(path: &Path, bytes: &[u8], folders: &mut Vec<PathBuf>) -> io::Result<()> {
    if let Some(folder) = path.parent().filter(|folder| !folders.iter().any(|known| known == folder)) {
        fs::create_dir_all(folder)?;
        folders.push(folder.to_owned());
    }
    let mut file = File::create_new(path)?;
    file.write_all(bytes)?;
    file.sync_all()
}

fn sync(folder: &Path) -> io::Result<()> {
    File::open(folder)?.sync_all()
}

/// One step of the file system; where it knows none (some network shares), two, between which the place is empty and
/// both folders lie beside it.
fn exchange(new: &Path, place: &Path) -> io::Result<()> {
    if !place.exists() {
        return fs::rename(new, place);
    }
    if renameat_with(CWD, new, CWD, place, RenameFlags::EXCHANGE).is_ok() {
        return Ok(());
    }
    let former = new.with_extension("former");
    fs::rename(place, &former)?;
    fs::rename(new, place)?;
    fs::rename(&former, new)
}

#[cfg(test)]
#[path = "folder_tests.rs"]
mod tests;
