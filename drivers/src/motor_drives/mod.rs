//! A base whose wheels have motor controllers other than CiA 402 drives: ODrive, VESC or Roboteq on a CAN bus, Roboteq or a wheel line on a
//! serial one (book, Motor controllers).
//!
//! One master for all: it leads the wheels to their speeds together, as [`wheel_drives`](crate::wheel_drives) does, and does not drive
//! before it knows that a controller stops by itself when the computer is silent, wherever the controller can show it. A serial line
//! comes in frames of up to eight bytes with the identifier 0, and goes the same way as a bus.

mod base;
mod configuration;
mod judgement;
mod link;
mod odrive_link;
mod roboteq_bus_link;
mod roboteq_link;
mod vesc_link;
mod watchdog;
mod wheel;
mod wheel_line_link;

pub use base::MotorDrives;
pub use configuration::{MotorDrivesConfiguration, MotorProtocol};
pub use watchdog::WatchdogCheck;

#[cfg(test)]
mod base_tests;
#[cfg(test)]
mod roboteq_bus_tests;
