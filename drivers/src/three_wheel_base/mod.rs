//! FLOBOT's base on one CAN bus: a traction and a steering drive, two encoders, the safety controller's gateway.

mod base;
mod configuration;
pub(crate) mod drives;
mod encoders;
pub(crate) mod following_error;

pub use base::{BaseCounters, BaseEvent, ThreeWheelBase};
pub use configuration::BaseConfiguration;
pub use drives::{DriveCommand, StopKind};

#[cfg(test)]
mod base_tests;
#[cfg(test)]
mod bus_tests;
