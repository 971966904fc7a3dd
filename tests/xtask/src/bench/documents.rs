//! The measurements as BENCHMARKS.md and the README show them.

use std::path::Path;

use anyhow::{Context, Result};

use super::history::{self, Measurement};
use super::table;

/// A document and the marks between which it is written; what stands around them is written by hand.
struct Block {
    file: &'static str,
    begin: &'static str,
    end: &'static str,
    text: fn(&[Measurement]) -> Option<String>,
}

const BLOCKS: [Block; 2] = [
    Block {
        file: "BENCHMARKS.md",
        begin: "<!-- written by cargo xtask bench --peers -->",
        end: "<!-- end -->",
        text: table::for_benchmarks,
    },
    Block {
        file: "README.md",
        begin: "<!-- best peers, written by cargo xtask bench --peers -->",
        end: "<!-- end of the best peers -->",
        text: table::for_readme,
    },
];

/// Writes the kept measurements into both documents.
///
/// # Errors
/// There is none, or a document has lost its marks.
pub fn render(root: &Path) -> Result<()> {
    let all = history::read(root)?;
    for block in &BLOCKS {
        let (_, new) = block.documents(root, &all)?;
        std::fs::write(root.join(block.file), new).with_context(|| format!("cannot write {}", block.file))?;
    }
    Ok(())
}

impl Block {
    /// The document as it is, and as it should be.
    fn documents(&self, root: &Path, all: &[Measurement]) -> Result<(String, String)> {
        let text = (self.text)(all).context("nothing was measured yet")?;
        let is = std::fs::read_to_string(root.join(self.file))
            .with_context(|| format!("cannot read {}", self.file))?;
        let should_be =
            self.replaced(&is, &text).with_context(|| format!("{} has lost its marks", self.file))?;
        Ok((is, should_be))
    }

    fn replaced(&self, document: &str, text: &str) -> Option<String> {
        let (before, rest) = document.split_once(self.begin)?;
        let (_, after) = rest.split_once(self.end)?;
        Some(format!("{before}{}\n\n{text}\n{}{after}", self.begin, self.end))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn documents_show_the_kept_measurements() {
        let root = crate::shell::root();
        let all = history::read(&root).expect("measurements");
        for block in &BLOCKS {
            let (is, should_be) = block.documents(&root, &all).expect("a document");
            assert!(is == should_be, "{}: run `cargo xtask bench --render`", block.file);
        }
    }
}
