//! Where the robot is and how it moves: wheels and gyroscope in one filter, a history of poses for stamping scans.
//! Source: book, Odometry.

mod ackermann;
mod base_model;
mod filter;
mod pose_history;
mod side_wheels;
mod tricycle;
mod wheels;

pub use ackermann::{Ackermann, SteeredAxle};
pub use base_model::{BaseModel, VelocityCovariance};
pub use filter::{Odometry, OdometryCounters, OdometryNoise};
pub use pose_history::{PoseHistory, PoseLookupError};
pub use side_wheels::{SideSpeeds, SideWheels};
pub use tricycle::{SteeredWheel, Tricycle};
pub use wheels::{WheelGeometry, WheelMotion, WheelOdometry};
