//! The floor camera live: pictures from the kernel or from a folder, checked, and what they tell the rings.
//!
//! A picture that is late, frozen, from the future or of another size is unknown floor, never clean or free floor.

mod device;
mod dirt_stage;
mod floor_stage;
mod folder_names;
mod folder_source;
mod frame_source;
mod kernel_source;
mod log_throttle;
mod pairing;
mod people;
mod picture_folder;
mod pixels;
mod watch;
mod watcher;

pub use device::Device;
pub use dirt_stage::{DirtBlind, DirtStage, SeenDirt};
pub use floor_stage::FloorStage;
pub use folder_names::stamp_us as stamp_of_name;
pub use folder_source::FolderSource;
pub use frame_source::{ColourPicture, FrameEvent, FrameSource};
pub use kernel_source::KernelSource;
pub use people::DepthPeopleStage;
pub use picture_folder::{DepthPicture, FloorMounting, PictureCamera, PictureFolder};
pub use pixels::{ColourFormat, WrongFrame, colour_of, depth_of};
pub use watch::{CameraEvent, LiveSource, open_source, watch_floor};
pub use watcher::{Attended, Watcher};
