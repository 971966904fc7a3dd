//! Every loop and every iterator chain of the audited layers, with its bound.
//!
//! `no_std` without an allocator leaves only slices, arrays and containers of fixed capacity, so walking one of them is
//! bounded by its capacity. Ranges must end in something whose largest value is visible (`bounds`). `while` and `loop`
//! have no bound that a reader can see and are refused, except in an `async fn` whose every turn waits for the world (the drivers' thin adaptors).
//!
//! Limits: the syntax is not typed. That a receiver is a container and not an endless iterator is checked by refusing
//! the sources of endless iteration (`repeat`, `cycle`, `from_fn`, `successors`, open ranges, a range kept in a name or
//! chosen by a caller) wherever they stand, unless the same chain says `take(CONSTANT)` or zips with a container; and
//! by refusing iterators of our own but for those in `own_iterator` of the facts.

use crate::claim::Finding;
use crate::loops::rewrite::Edit;
use crate::loops::seen::Seen;
use crate::loops::visitor;
use crate::sources::SourceFile;
use serde::Serialize;

/// One loop or iterator chain.
#[derive(Debug, Clone, Serialize)]
pub struct LoopSite {
    /// File from the workspace root.
    pub file: String,
    /// First line.
    pub line: usize,
    /// Last line.
    pub end_line: usize,
    /// Function that holds it.
    pub function: String,
    /// `for`, `while`, `loop` or the consuming method of a chain.
    pub kind: String,
    /// The bound: a constant, a capacity, a container.
    pub bound: String,
    /// How the bound is known.
    pub how: &'static str,
    /// What to write into the source so that it counts its turns; nothing where that cannot be done.
    #[serde(skip)]
    pub edits: Vec<Edit>,
    /// What the counters saw.
    #[serde(flatten)]
    pub seen: Seen,
}

/// Lists the loops of one file; what has no bound becomes a finding.
pub fn list(file: &SourceFile) -> (Vec<LoopSite>, Vec<Finding>) {
    let (sites, mut findings) = visitor::walk(file);
    // A loop and the endless source in its head are one mistake.
    findings.dedup_by_key(|finding| finding.line);
    (sites, findings)
}
