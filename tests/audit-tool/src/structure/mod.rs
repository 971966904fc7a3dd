//! `cargo xtask structure`: which crate and which module knows which, how long files and modules are.
//!
//! The table of ARCHITECTURE.md says what may depend on what; an arrow that it does not allow fails, and so does a cycle between
//! crates or between the top modules of one. What was found the day that a rule was made stands in a list that can only shrink.

mod allowed;
mod claims;
mod crates;
mod drawing;
mod graph;
mod known;
mod modules;
#[cfg(test)]
mod planted_tests;
mod run;
mod sizes;

pub use claims::judge;
pub use run::{Options, run};
