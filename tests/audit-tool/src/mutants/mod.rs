//! `cargo xtask campaign mutants-guard` and `mutants-drivers`: the code is mutated in one place, the tests must notice.
//!
//! cargo-mutants lists the possible mutations. To build the crate for each of thousands of mutants takes hours, so
//! nearly all are written into one copy of it (`branches`), each behind a branch that an environment variable switches
//! on (`switch.rs.in`). What cannot be a branch, such as a constant, is built by itself (`alone`).

mod alone;
mod branches;
mod edits;
mod list;
mod mutated_copy;
mod outcome;
pub mod record;
mod run;
mod trial;

pub use record::{EQUIVALENT, Equivalent, RECORD, Record};
pub use run::run;
