//! Where the robot is: odometry, a history of poses, and how well a scan fits a map.
//!
//! No heap, no clock, no I/O, no `unsafe`, no panic.
//!
#![doc = include_str!("../README.md")]
#![no_std]
#![forbid(unsafe_code)]
#![cfg_attr(
    not(test),
    deny(
        clippy::unwrap_used,
        clippy::expect_used,
        clippy::panic,
        clippy::unreachable,
        clippy::todo,
        clippy::unimplemented,
        clippy::indexing_slicing,
        clippy::as_conversions
    )
)]

#[cfg(test)]
extern crate std;

pub mod graph_mapping;
mod motion_model;
pub mod odometry;
mod range_model;
mod resample;
pub mod scan_matching;

pub use motion_model::{MotionNoise, OdometryStep, sample_motion};
pub use range_model::{BEAMS_TO_JUDGE, RangeModel, RangeModelConfig};
pub use resample::{normalise, systematic};
