//! Loops of the sources with their bounds, where a counter goes into them, and what was counted.

mod bounds;
mod listed;
mod matched;
mod record;
pub mod rewrite;
pub mod seen;
mod syntax;
mod visitor;
mod walks;
mod words;

pub use bounds::shown;
pub use listed::{LoopSite, list};
pub use record::{Record, numbers, written};
pub use seen::RECORD;
pub use walks::chain_root;
