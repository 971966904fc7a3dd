//! Motor controllers other than CiA 402 drives, as their makers describe them: their wires, their watchdogs (book, Motor controllers).
//! Written from those documents; nothing of the robot's own codecs is used.

mod bank;
mod odrive;
mod roboteq;
mod roboteq_bus;
mod text;
mod vesc;
mod wheel_line;

pub use bank::{MotorBank, MotorKind, MotorParameters};
