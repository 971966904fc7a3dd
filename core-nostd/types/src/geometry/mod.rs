//! Poses, transforms and angles. All frames are right-handed: x forward, y left, z up; angles counter-clockwise.

mod angle;
mod pose2;
mod transform3;

pub use angle::wrap_angle;
pub use pose2::{Point2, Pose2, Twist2};
pub use transform3::{Point3, Transform3};
