//! The three-wheeled robot: parameters and physics.

mod parameters;
mod physics;
mod velocity_base;

pub use parameters::{BodyPrism, NodeIds, RobotParameters, ScannerDevice, SensorMount};
pub use physics::{BrakeLaw, RobotBody};
pub use velocity_base::VelocityBase;
