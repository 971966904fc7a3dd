//! The robot on the board's own devices: UDP, UARTs, timers, two rings of different priority.

mod guard_ring;
mod network;
pub mod options;
mod perception_ring;
mod witness;

pub use guard_ring::start_guard_ring;
pub use perception_ring::start_perception_ring;

use embassy_sync::blocking_mutex::raw::CriticalSectionRawMutex;
use floorguard_runtime::shared::Shared;

/// What both rings share.
pub type RobotShared = Shared<CriticalSectionRawMutex>;
