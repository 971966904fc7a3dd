//! The files in which Linux says what it is and what it permits, below a root that a test can replace.

use std::path::{Path, PathBuf};

use rustix::fs::{Access, access};

/// A computer.
pub(super) struct Computer {
    root: PathBuf,
    /// Whether a thread got the real-time priority of the guard ring; otherwise why not.
    pub(super) real_time: Result<(), String>,
}

impl Computer {
    /// Files are looked up below `root`; `real_time` was tried by the caller.
    pub(super) const fn at(root: PathBuf, real_time: Result<(), String>) -> Self {
        Self { root, real_time }
    }

    /// Where an absolute path of the computer is.
    pub(super) fn path(&self, absolute: &Path) -> PathBuf {
        self.root.join(absolute.strip_prefix("/").unwrap_or(absolute))
    }

    /// The text of a file without its last newline; `None` where it cannot be read.
    pub(super) fn text(&self, absolute: &str) -> Option<String> {
        let text = std::fs::read_to_string(self.path(Path::new(absolute))).ok()?;
        Some(text.trim_end().to_owned())
    }

    /// A file that holds one whole number.
    pub(super) fn number(&self, absolute: &str) -> Option<u64> {
        self.text(absolute)?.parse().ok()
    }

    pub(super) fn exists(&self, absolute: &Path) -> bool {
        self.path(absolute).exists()
    }

    /// Whether this user may read and write a file.
    pub(super) fn may_use(&self, absolute: &Path) -> bool {
        access(self.path(absolute), Access::READ_OK | Access::WRITE_OK).is_ok()
    }

    /// Names of the entries of a folder, in order; empty where it cannot be read.
    pub(super) fn entries(&self, absolute: &str) -> Vec<String> {
        let Ok(folder) = std::fs::read_dir(self.path(Path::new(absolute))) else { return Vec::new() };
        let mut names: Vec<String> =
            folder.flatten().map(|entry| entry.file_name().to_string_lossy().into_owned()).collect();
        names.sort();
        names
    }

    /// Where a symbolic link leads, as it is written.
    pub(super) fn link(&self, absolute: &str) -> Option<String> {
        let target = std::fs::read_link(self.path(Path::new(absolute))).ok()?;
        Some(target.to_string_lossy().into_owned())
    }
}
