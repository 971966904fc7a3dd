//! Sampling-based predictive control (model predictive path integral, Williams and others 2017): many velocities are tried on
//! a model of drive, costmap, people and guard, and averaged by how well they do.

mod config;
mod forecast;
mod noise;
mod path_left;
mod planner;
mod rollout;

pub use config::{MPPI_STEPS, MppiConfig, MppiWeights};
pub use planner::{Mppi, MppiSample};
