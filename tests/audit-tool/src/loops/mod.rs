//! Loops of the sources with their bounds, where a counter goes into them, and what was counted.

mod bounds;
mod listed;
pub mod rewrite;
pub mod seen;
mod syntax;
mod visitor;
mod walks;
mod words;

pub use bounds::shown;
pub use listed::{LoopSite, list};
pub use seen::{RECORD, Record, numbers, written};
pub use walks::chain_root;
