//! The order of a run in real time: which task of the guard ring ran when, what it got, and what was decided in it.
//!
//! Threads are not scheduled the same way twice. What a computer decides in real time depends on the order in which bytes,
//! timers, advice and commands reach the guard, so a recording keeps that order, and a replay follows it.

mod bytes;
mod decision_row;
mod entry;
mod log;

pub use decision_row::{CauseRow, DecisionRow};
pub use entry::{OrderEntry, OrderReader, PolledRow, read_entries};
pub use log::OrderLog;

/// Name of the text of a run that holds its order, and the version of its entries.
pub const ORDER: &str = "order";
/// This version.
pub const ORDER_VERSION: &str = "1";
