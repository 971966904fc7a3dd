//! The floor camera live: pictures from the kernel, checked, and what they tell the rings.
//!
//! A picture that is late, frozen, from the future or of another size is unknown floor, never clean or free floor.

mod device;
mod dirt_look;
mod look;
mod people;
mod pixels;
mod watch;

pub use device::Device;
pub use dirt_look::{DirtBlind, DirtLook, SeenDirt};
pub use look::FloorLook;
pub use people::PeopleLook;
pub use pixels::{ColourFormat, WrongFrame, colour_of, depth_of};
pub use watch::watch_floor;
