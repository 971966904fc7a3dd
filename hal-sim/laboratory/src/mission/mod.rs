//! Cleaning missions in simulation: any ROS map, four strategies, and the proof of what was claimed.

mod campaign;
mod config;
mod environment;
mod faults;
mod memory;
mod navigator;
mod outcome;
mod people;
pub mod pictures;
mod promise;
mod random_drive;
pub mod report;
mod routes;
pub mod statistics;
mod trial;
mod truth;

pub use campaign::{RunMonitor, StrategySummary, StrategyTrials, run_strategies, run_strategies_believing};
pub use config::{Guarantee, MissionConfig, Robot, Strategy};
pub use environment::{CleaningLesson, expected_units, teach_cleaning};
pub use faults::{FaultKind, FaultRates};
pub use memory::Memory;
pub use outcome::TrialResult;
pub use trial::{Interrupted, MissionStorage, run, run_believing, run_keeping};
pub use truth::{OdometryErrors, RangeSensor};
