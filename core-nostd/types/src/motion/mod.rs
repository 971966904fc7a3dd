//! Contracts between localisation, mapping, navigation and guard: where the robot is, what shape it has, how its drive
//! can move, which people move near it, and which motions the guard will permit.

mod drive_kinematics;
mod footprint;
mod moving_person;
mod permission;
mod pose_estimate;
mod waypoint;

pub use drive_kinematics::{DriveGeometry, DriveKinematics};
pub use footprint::{FOOTPRINT_CORNERS_MAX, Footprint, FootprintError};
pub use moving_person::MovingPerson;
pub use permission::{AlwaysPermitted, Permission, PermittedMotion, PlannedMotion};
pub use pose_estimate::{PoseCovariance, PoseEstimate};
pub use waypoint::{Gear, Waypoint};
