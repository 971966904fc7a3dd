//! The three-wheeled robot: parameters and physics.

mod parameters;
mod physics;

pub use parameters::{BodyPrism, NodeIds, RobotParameters, ScannerDevice, SensorMount};
pub use physics::{BrakeLaw, RobotBody};
