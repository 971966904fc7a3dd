//! Where the robot is and how it moves: wheels and gyroscope in one filter, a history of poses for stamping scans.
//! Source: book, Odometry.

mod filter;
mod pose_history;
mod tricycle;
mod wheels;

pub use filter::{Odometry, OdometryCounters, OdometryNoise};
pub use pose_history::{PoseHistory, PoseLookupError};
pub use tricycle::Tricycle;
pub use wheels::{WheelGeometry, WheelMotion, WheelOdometry};
