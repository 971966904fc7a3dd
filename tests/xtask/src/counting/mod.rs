//! `cargo xtask campaign loops`: how often each loop of core and drivers turned at most, in all tests.
//!
//! The sources are copied, a counter is written into each listed loop of the copy, and the tests run there.

mod rewrite;
mod run;
mod tree;

pub use rewrite::{Edit, of_chain, of_for_loop};
pub use run::run;
