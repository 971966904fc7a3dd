//! The emulated board on real wires: UDP and serial sockets, the simulator at their other end.

mod board;
mod faults;
mod line;
mod outcome;
mod play;
mod report;

pub use faults::run_faults;
pub use outcome::Outcome;
pub use play::{Options, run};
