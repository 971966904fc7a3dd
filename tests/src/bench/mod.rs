//! How long the stages take: medians over many rounds, on the recordings that everybody else is measured on.

mod lidar;

pub use lidar::{StageTime, run};
