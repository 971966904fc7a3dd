//! The laboratory: worlds in which the robot's own tasks run against the simulator, the judge of what they do, campaigns,
//! evaluation on recorded data, training, and mission trials. The robot's program is built without it.

#[macro_use]
extern crate floorguard_host;

pub mod campaign;
pub mod evaluate;
pub mod judge;
pub mod metrics;
pub mod mission;
pub mod models;
pub mod plan;
pub mod run_report;
pub mod status;
pub mod train;
pub mod world;
