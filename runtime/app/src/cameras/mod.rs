//! Colour cameras beside the lidar: how they are mounted, their pictures, and people in them.

mod calibrate;
mod camera_file;
#[cfg(feature = "detector")]
mod detect;
mod pictures;

pub use calibrate::{CalibrateArguments, CalibrateWhat, CameraLidarArguments, run as calibrate};
pub(crate) use camera_file::CameraFile;
#[cfg(feature = "detector")]
pub use detect::{DetectArguments, run as detect_people};
pub(crate) use pictures::{TakenPicture, for_each_picture};
