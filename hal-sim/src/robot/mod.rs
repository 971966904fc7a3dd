//! The robot, on whatever wheels: parameters and physics.

mod brush_deck;
mod parameters;
mod physics;
mod rolling;
mod velocity_base;

pub use crate::wire::OusterFormat;
pub use brush_deck::{BrushDeck, BrushPass};
pub use parameters::{
    BodyPrism, BridgedScans, HokuyoModel, ImuDevice, LidarDevice, NodeIds, OusterDevice, RobotParameters,
    RplidarModel, ScannerDevice, SensorMount, SickModel, Train,
};
pub use physics::{BrakeLaw, RobotBody};
pub use velocity_base::VelocityBase;
