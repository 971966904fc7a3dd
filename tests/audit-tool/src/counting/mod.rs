//! `cargo xtask campaign loops`: how often each loop of core and drivers turned at most, in all tests.
//!
//! The sources are copied, a counter is written into each listed loop of the copy, and the tests run there.

mod run;
mod tree;

pub use run::run;
