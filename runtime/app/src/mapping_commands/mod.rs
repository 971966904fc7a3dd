//! Maps of buildings: made out of recordings, judged, and used to find the robot again.

mod arguments;
mod calibrate;
mod camera_file;
mod checkpoint;
mod clean;
#[cfg(feature = "detector")]
mod detect;
mod eval_slam;
mod files;
mod input;
mod localise;
mod map;
mod map3d;
mod map_edit;
mod progress;
mod report;
mod summary;

pub use arguments::{DriveArguments, LocaliseArguments, Map3dArguments, MapArguments, SlamArguments};
pub use calibrate::{CalibrateArguments, CalibrateWhat, CameraLidarArguments, run as calibrate};
pub use clean::{BoxMethod, CleanArguments, run as clean_map};
#[cfg(feature = "detector")]
pub use detect::{DetectArguments, run as detect_people};
pub use eval_slam::run as eval_slam;
pub(crate) use files::text;
pub use localise::run as localise;
pub use map::run as map;
pub use map3d::run as map3d;
