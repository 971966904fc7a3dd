//! A base whose wheels each have a CiA 402 drive, on one CAN bus with the safety controller's gateway: a differential base with two
//! drives, an omnidirectional one with four (book, CANopen: Wheel drives).

mod base;
pub(crate) mod configuration;
mod drives;
pub(crate) mod sides;

pub use base::WheelDrives;
pub use configuration::WheelDrivesConfiguration;
pub use drives::WheelCommand;
pub use sides::SideTargets;

#[cfg(test)]
mod base_tests;
