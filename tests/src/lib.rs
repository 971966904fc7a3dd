//! Judges. What the test files share: where the recordings are, and how a missing one is reported.

pub mod barn;
pub mod bench;
pub mod campaign;
pub mod candidates;
pub mod corridor;
pub mod crowds;
pub mod data;
pub mod dirt;
pub mod environment;
pub mod exploration;
pub mod fuzz;
pub mod lidar_frames;
pub mod online;
pub mod pedestrians;
pub mod prediction;
pub mod removal;
pub mod reproduce;
pub mod rgbd;
pub mod second_look;
pub mod slam;
pub mod wired;
pub mod worst;
