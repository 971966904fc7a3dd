//! A two-dimensional lidar on its side that a motor turns about a vertical axis, in a room with people: the bytes of both wires
//! (book, SCIP 2.0; book, CANopen), and the panoramic picture of a camera above it.

mod lidar;
mod motor;
mod picture;
mod rig;
mod room;

pub use lidar::{LidarModel, ScanLidar};
pub use motor::TurningMotor;
pub use picture::{MIRROR, MirrorCamera, PersonView, Ring};
pub use rig::{MountedLidar, Rig, RigEvent, RigFault};
pub use room::{ROOMS, Room};
