//! Inertial sensors: one contract over the makers' protocols.
//!
//! Samples are in the sensor's own axes, put so that a sensor that lies flat with its label up has x as printed on it, y to the left of
//! that and z up: what a mounting without angles means.

mod any_sensor;
mod contract;

pub use any_sensor::AnyInertialSensor;
pub use contract::{InertialEvent, InertialFault, InertialSensor};
