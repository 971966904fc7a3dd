//! `cargo xtask campaign mutants-guard` and `mutants-drivers`: cargo-mutants spoils the code, the tests must notice.

pub mod record;
mod run;

pub use record::{RECORD, Record};
pub use run::run;
