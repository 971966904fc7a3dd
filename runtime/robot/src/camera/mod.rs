//! The floor camera live: pictures from the kernel or from a folder, checked, and what they tell the rings.
//!
//! A picture that is late, frozen, from the future or of another size is unknown floor, never clean or free floor.

mod device;
mod dirt_look;
mod eye;
mod folder_eye;
mod folder_names;
mod kernel_eye;
mod look;
mod pairing;
mod people;
mod picture_folder;
mod pixels;
mod said;
mod watch;
mod watcher;

pub use device::Device;
pub use dirt_look::{DirtBlind, DirtLook, SeenDirt};
pub use eye::{Eye, News};
pub use folder_eye::FolderEye;
pub use kernel_eye::KernelEye;
pub use look::FloorLook;
pub use people::PeopleLook;
pub use picture_folder::{PictureCamera, PictureFolder};
pub use pixels::{ColourFormat, WrongFrame, colour_of, depth_of};
pub use watch::{CameraNews, LiveEye, open_eye, watch_floor};
pub use watcher::{Attended, Watcher};
