//! Tables of numbers from files, packed or not.

use std::path::Path;

use floorguard_host::outcome::BadInput;
use floorguard_host::packing;

/// The text of a file, packed or not; the packing is recognised by its first bytes, not by its name.
///
/// # Errors
/// The file cannot be read, is cut off or is no text.
pub fn read_text(path: &Path) -> anyhow::Result<String> {
    let bad = |problem: std::io::Error| {
        BadInput(format!(
            "{}: cannot be read ({problem}); copy it again, or give another file",
            path.display()
        ))
    };
    let text = packing::text(path).map_err(bad)?;
    // Spreadsheets begin a text with a mark that nobody sees.
    Ok(text.strip_prefix('\u{feff}').map_or_else(|| text.clone(), str::to_owned))
}

/// One line of a table as numbers; an error names file and line.
pub fn numbers(path: &Path, line: usize, content: &str) -> anyhow::Result<Vec<f64>> {
    content.split(',').map(|cell| number(path, line, cell)).collect()
}

/// A cell of a table as a number; infinite and not-a-number are none.
pub fn number(path: &Path, line: usize, cell: &str) -> anyhow::Result<f64> {
    let cell = cell.trim();
    if let Some(number) = cell.parse::<f64>().ok().filter(|number| number.is_finite()) {
        return Ok(number);
    }
    let remedy = match cell {
        "" => "is the file cut off?",
        _ if cell.contains([';', '\t', ' ']) => "separate the cells by commas",
        _ => "write a finite number",
    };
    Err(BadInput(format!("{}, line {line}: `{cell:.40}` is no number; {remedy}", path.display())).into())
}
