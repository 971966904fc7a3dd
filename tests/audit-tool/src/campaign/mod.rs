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

pub use kinds::exists;
pub use run::{Options, run};
