//! A counted loop as it is kept, and its name.

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};

use super::LoopSite;

/// One counted loop, as it is kept.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct Record {
    /// File from the workspace root.
    pub file: String,
    /// Function that holds it.
    pub function: String,
    /// `for`, or the method.
    pub kind: String,
    /// Number among those of its kind in functions of that name in the file.
    pub number: usize,
    /// The bound as its text says.
    pub bound: String,
    /// Most turns; `None`: it never ran.
    pub largest: Option<u64>,
    /// The bound as a number, 0 where the type of a slice does not tell.
    pub bound_value: u64,
}

/// The records as they are kept: one loop a line, so that a change can be read.
pub fn written(records: &[Record]) -> anyhow::Result<String> {
    let lines: Vec<String> = records.iter().map(serde_json::to_string).collect::<Result<_, _>>()?;
    Ok(format!("[\n{}\n]\n", lines.join(",\n")))
}

/// What a record is found by.
pub type Name = (String, String, String, usize, String);

impl Record {
    /// What it is found by.
    pub fn name(&self) -> Name {
        let text = |text: &String| text.clone();
        (text(&self.file), text(&self.function), text(&self.kind), self.number, text(&self.bound))
    }
}

/// The names of all loops, in their order.
pub fn numbers(sites: &[LoopSite]) -> Vec<usize> {
    let mut next = BTreeMap::new();
    let number = |site: &LoopSite| {
        let count: &mut usize =
            next.entry((site.file.clone(), site.function.clone(), site.kind.clone())).or_default();
        let number = *count;
        *count += 1;
        number
    };
    sites.iter().map(number).collect()
}
