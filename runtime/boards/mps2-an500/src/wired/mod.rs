//! The robot on the board's own devices: UDP, UARTs, timers, two rings of different priority.

mod guard_ring;
mod network;
pub mod options;
mod witness;

pub use guard_ring::start_guard_ring;
