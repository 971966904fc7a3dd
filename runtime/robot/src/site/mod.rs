//! The place where the robot works: its map, floor, lanes, rooms and expected dirt, and where on it the robot is.

mod cells_around;
mod dirt_source;
mod floor;
mod lanes;
mod localiser;
mod recent_poses;
pub mod rooms;
pub mod ros_map;
mod scan_ends;
pub mod scrubber;
mod uncredited;

pub use cells_around::cells_around;
pub use dirt_source::{DirtSource, read_places};
pub use floor::{CELL_M, CELLS_MAX, Floor};
pub use lanes::lanes;
pub use localiser::{DirtyCells, Localiser, PARTICLES};
pub use recent_poses::RecentPoses;
pub use scan_ends::ends_of;
