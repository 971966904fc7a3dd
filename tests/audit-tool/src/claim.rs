//! A claim, what speaks for it, and what speaks against it.

use serde::Serialize;

/// Something that contradicts a claim, with the place to look.
#[derive(Debug, Clone, Serialize, PartialEq, Eq, PartialOrd, Ord)]
pub struct Finding {
    /// File from the workspace root, or the function's name for compiled code.
    pub place: String,
    /// Line, 0 where there is none.
    pub line: usize,
    /// What is wrong and what would be right.
    pub message: String,
}

/// One claim of the evidence.
#[derive(Debug, Serialize)]
pub struct Claim {
    /// Stable name.
    pub id: &'static str,
    /// What is claimed, in a sentence.
    pub text: &'static str,
    /// How it was checked, with figures.
    pub evidence: String,
    /// What contradicts it; empty means that it holds.
    pub findings: Vec<Finding>,
}

impl Claim {
    /// Nothing contradicts it.
    pub fn holds(&self) -> bool {
        self.findings.is_empty()
    }
}
