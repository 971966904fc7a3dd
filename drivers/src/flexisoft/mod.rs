//! The gateway of a SICK Flexi Soft safety controller (book, Safety inputs: Flexi Soft gateway).

mod image;
mod map;

pub use image::SafetyImage;
pub use map::{IMAGE_OBJECTS, InputBits, InputMap};
