//! The robot on the board's own devices: UDP, UARTs, timers, two rings of different priority.

mod bench_link;
mod guard_ring;
mod network;
pub mod options;

pub use guard_ring::start_guard_ring;
