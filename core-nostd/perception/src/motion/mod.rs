//! Moving objects: which cluster of a sweep moves by itself, after the robot's own motion is taken out (DATMO).
//!
//! Seven steps (book, Motion). Pose, floor and clusters come from `odometry` and `people`; here are the
//! correspondence of objects between sweeps, the change of each against what the space held a moment before, and
//! the confidence that turns single results into a verdict.

mod confidence;
mod correspondence;
mod detector;
mod live;
mod parameters;
mod parts;
mod reference;
mod seen_through;
mod voxels;

pub use confidence::MovingObject;
pub use correspondence::MotionObject;
pub use detector::{MotionCounters, MotionDetector, MotionDetectorOf, MotionOutput, Verdict};
pub use live::{find_moving_people, find_moving_people_with_second_look};
pub use parameters::{CHAIN_MAX, MotionParameters};
pub use parts::Part;
