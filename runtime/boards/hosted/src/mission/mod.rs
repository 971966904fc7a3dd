//! Cleaning missions in simulation: any ROS map, four strategies, and the proof of what was claimed.

mod campaign;
mod config;
mod dirt_source;
mod faults;
mod floor;
mod lanes;
mod localiser;
mod memory;
mod navigator;
mod people;
pub mod pictures;
mod promise;
pub mod report;
pub mod rooms;
pub mod ros_map;
pub mod scrubber;
pub mod statistics;
mod trial;
mod truth;

pub use campaign::{Onlooker, StrategySummary, StrategyTrials, run_strategies, run_strategies_believing};
pub use config::{Guarantee, MissionConfig, Robot, Strategy};
pub use dirt_source::{DirtSource, read_places};
pub use faults::{FaultKind, FaultRates};
pub use floor::{CELL_M, CELLS_MAX, Floor};
pub(crate) use lanes::{Lane, lanes};
pub(crate) use localiser::Localiser;
pub use memory::Memory;
pub use trial::{Interrupted, Keeping, TrialResult, run, run_believing, run_keeping};
pub use truth::{OdometryErrors, RangeSensor};
