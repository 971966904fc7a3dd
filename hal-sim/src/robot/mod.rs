//! The three-wheeled robot: parameters and physics.

mod parameters;
mod physics;

pub use parameters::{NodeIds, RobotParameters, ScannerDevice, SensorMount};
pub use physics::{BrakeLaw, RobotBody};
