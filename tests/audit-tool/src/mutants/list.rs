//! The possible mutations, as cargo-mutants lists them.

use std::process::Stdio;

use anyhow::{Context, Result, bail};
use serde::Deserialize;

use crate::shell;

/// One change of the code.
#[derive(Debug, Clone, PartialEq, Eq, Deserialize)]
pub struct Mutant {
    /// `FILE:LINE:COLUMN: CHANGE in FUNCTION`.
    pub name: String,
    /// File from the workspace root.
    pub file: String,
    /// What kind of change.
    pub genre: Genre,
    /// What is put into the span.
    pub replacement: String,
    /// What is replaced.
    pub span: Span,
}

/// A kind of change.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize)]
pub enum Genre {
    /// The body of a function becomes one value.
    FnValue,
    /// Another operator between two operands.
    BinaryOperator,
    /// An operator before one operand goes.
    UnaryOperator,
    /// An arm of a `match` goes; there is one that takes everything.
    MatchArm,
    /// The condition of an arm becomes `true` or `false`.
    MatchArmGuard,
    /// A field of a value goes, and has the value of the base.
    StructField,
    /// What a later cargo-mutants may invent.
    #[serde(other)]
    Unknown,
}

/// From a character to before another.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize)]
pub struct Span {
    /// First character.
    pub start: Place,
    /// The one behind the last.
    pub end: Place,
}

/// Both count from 1, columns in characters.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Deserialize)]
pub struct Place {
    /// Line.
    pub line: usize,
    /// Column.
    pub column: usize,
}

impl Place {
    /// Where a piece of syntax begins.
    pub fn of(syntax: &impl syn::spanned::Spanned) -> Self {
        let start = syntax.span().start();
        Self { line: start.line, column: start.column + 1 }
    }

    /// The byte in a text, if it is in it.
    pub fn byte(self, text: &str) -> Option<usize> {
        let line = text.split_inclusive('\n').nth(self.line.checked_sub(1)?)?;
        let before: usize = text.split_inclusive('\n').take(self.line - 1).map(str::len).sum();
        let column = self.column.checked_sub(1)?;
        let within = line.char_indices().map(|(at, _)| at).chain([line.len()]).nth(column)?;
        Some(before + within)
    }
}

/// Asks cargo-mutants about some files of a package.
pub fn ask(package: &str, files: &[String]) -> Result<Vec<Mutant>> {
    if !shell::is_installed("cargo-mutants") {
        bail!("cargo-mutants is missing: cargo install cargo-mutants --locked");
    }
    let mut command = shell::cargo();
    command.args(["mutants", "--list", "--json", "--package", package]).stderr(Stdio::inherit());
    for file in files {
        command.args(["--file", file]);
    }
    let output = command.output().context("cannot start cargo mutants")?;
    if !output.status.success() {
        bail!("cargo-mutants does not list the mutants of {package}: {}", output.status);
    }
    serde_json::from_slice(&output.stdout).context("cargo-mutants lists the mutants in another form")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn place_maps_to_byte_behind_long_characters() {
        let text = "ab\nµs = 3;\n";
        assert_eq!(Place { line: 2, column: 3 }.byte(text).map(|at| &text[at..]), Some(" = 3;\n"));
        assert_eq!(Place { line: 4, column: 1 }.byte(text), None);
        assert_eq!(Place { line: 0, column: 1 }.byte(text), None);
    }
}
