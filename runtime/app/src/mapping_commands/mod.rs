//! Maps of buildings: made out of recordings, judged, and used to find the robot again.

mod arguments;
mod camera_colours;
mod checkpoint;
mod clean;
mod eval_slam;
mod input;
mod localise;
mod map;
mod map3d;
mod map_edit;
mod progress;
mod report;
mod summary;

pub use arguments::{DriveArguments, LocaliseArguments, Map3dArguments, MapArguments, SlamArguments};
pub use clean::{BoxMethod, CleanArguments, run as clean_map};
pub use eval_slam::run as eval_slam;
pub use localise::run as localise;
pub use map::run as map;
pub use map3d::run as map3d;
