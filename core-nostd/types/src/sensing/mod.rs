//! What drivers deliver: typed measurements with stamps, before anybody interprets them.

mod color_image;
mod depth_image;
mod dirt;
mod discrete;
mod frame_watch;
mod image_size;
mod lidar_packet;
mod motion_samples;
mod pinhole;
mod ring_choice;
mod scan;
mod stamped_image;
mod sweep;

pub use color_image::ColorImage;
pub use depth_image::DepthImage;
pub use dirt::DirtReading;
pub use discrete::{DiscreteInputs, SafetyInput};
pub use frame_watch::{FROZEN_FRAMES, FrameFault, FrameWatch, fingerprint};
pub use image_size::{ImageSize, WrongImageSize};
pub use lidar_packet::{LidarColumn, LidarColumnOf, LidarPacket, LidarPacketOf, Reflectivity, silent_cdeg};
pub use motion_samples::{DriveFeedback, DriveState, ImuSample, WheelSample};
pub use pinhole::{PinholeCamera, Pixel};
pub use ring_choice::RingChoice;
pub use scan::{BeamReturn, Scan, ScanOf};
pub use stamped_image::StampedImage;
pub use sweep::{Sweep, SweepColumn, SweepColumnOf, SweepOf, SweepPose};
