//! What drivers deliver: typed measurements with stamps, before anybody interprets them.

mod discrete;
mod lidar_packet;
mod motion_samples;
mod scan;
mod sweep;

pub use discrete::{DiscreteInputs, SafetyInput};
pub use lidar_packet::{LidarColumn, LidarPacket};
pub use motion_samples::{DriveFeedback, DriveState, ImuSample, WheelSample};
pub use scan::{BeamReturn, Scan};
pub use sweep::{Sweep, SweepColumn, SweepPose};
