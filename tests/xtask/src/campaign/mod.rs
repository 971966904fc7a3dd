//! `cargo xtask campaign`: the long runs, on all cores, with progress, resumed where they were cut.

mod block;
mod in_order;
mod interrupt;
mod kinds;
mod matrix;
mod program;
mod record;
mod run;
mod shares;
mod state;

#[cfg(test)]
pub use kinds::exists;
pub use record::code_today;
pub use run::{Options, run};
