//! What every microcontroller board has in common: the robot, the shared state, and the tasks that need no device.
//!
//! A board adds its devices, one thin task around each generic `async fn` that uses one, and its executors.
#![no_std]

#[cfg(target_os = "none")]
mod coupled_memory;
mod guard_ring;
mod kept_box;
#[cfg(feature = "defmt")]
mod log_events;
mod perception_ring;
mod robot;
mod shared;

pub use guard_ring::{FEED_EVERY, feed_while_deciding, spawn_deciders};
pub use kept_box::{KeptBox, REQUEST, keep_black_box, send_black_box};
#[cfg(feature = "defmt")]
pub use log_events::log_decisions;
pub use perception_ring::{fresh_perception, start_perception_ring};
pub use robot::robot;
pub use shared::{RobotShared, share};
