//! What every microcontroller board has in common: the robot, the shared state, and the tasks that need no device.
//!
//! A board adds its devices, one thin task around each generic `async fn` that uses one, and its executors.
#![no_std]

mod guard_ring;
mod kept_box;
mod perception_ring;
mod robot;
mod shared;
#[cfg(feature = "defmt")]
mod tell;

pub use guard_ring::{FEED_EVERY, feed_while_deciding, spawn_deciders};
pub use kept_box::{KeptBox, REQUEST, keep_black_box, tell_black_box};
pub use perception_ring::{fresh_perception, start_perception_ring};
pub use robot::robot;
pub use shared::{RobotShared, share};
#[cfg(feature = "defmt")]
pub use tell::tell_decisions;
