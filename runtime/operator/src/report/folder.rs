//! The folder of a report.

use std::path::Path;

use anyhow::Context as _;

/// Makes the folder of a report; before a long run, so that it is not in vain.
///
/// # Errors
/// It cannot be made.
pub fn make_folder(folder: &Path) -> anyhow::Result<()> {
    std::fs::create_dir_all(folder)
        .with_context(|| format!("{}: cannot make this folder; give another one", folder.display()))
}
