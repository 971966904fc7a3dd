//! Tables of numbers from files, packed or not.

use std::io::Read as _;
use std::path::Path;

use flate2::read::GzDecoder;

use crate::commands::BadInput;

/// First bytes of a gzip file.
const GZIP: [u8; 2] = [0x1F, 0x8B];

/// The text of a file; gzip is told by its first bytes, not by its name.
///
/// # Errors
/// The file cannot be read, is cut off or is no text.
pub fn read_text(path: &Path) -> anyhow::Result<String> {
    let bad = |problem: std::io::Error| BadInput(format!("{}: {problem}", path.display()));
    let bytes = std::fs::read(path).map_err(bad)?;
    let mut text = String::new();
    if bytes.starts_with(&GZIP) {
        GzDecoder::new(bytes.as_slice()).read_to_string(&mut text).map_err(bad)?;
    } else {
        text =
            String::from_utf8(bytes).map_err(|_| BadInput(format!("{}: this is no text", path.display())))?;
    }
    Ok(text)
}

/// One line of a table as numbers; an error names file and line.
pub(super) fn numbers(path: &Path, line: usize, content: &str) -> anyhow::Result<Vec<f64>> {
    let cell = |cell: &str| {
        cell.trim().parse::<f64>().map_err(|_| {
            BadInput(format!("{}, line {line}: `{}` is no number", path.display(), cell.trim())).into()
        })
    };
    content.split(',').map(cell).collect()
}
