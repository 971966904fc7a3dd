//! What the links of our own share: bridges of lidars, scanners and inertial sensors, and programs that drive the robot.

mod checksum;
mod fields;
mod order;

pub(crate) use checksum::{CHECKSUM, CHECKSUM_BYTES, Damage, damage};
pub(crate) use fields::bytes_at;
pub(crate) use order::{DatagramOrder, lost_before};

pub use order::OrderError;
