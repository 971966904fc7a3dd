//! The emulated board on real wires: UDP and serial sockets, the simulator at their other end.

mod black_box;
mod board;
mod faults;
mod line;
mod log;
mod outcome;
mod play;
mod report;

pub use faults::{Which, run_faults};
pub use outcome::Outcome;
pub use play::{Options, run};
