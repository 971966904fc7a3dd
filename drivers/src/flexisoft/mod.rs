//! The gateway of a SICK Flexi Soft safety controller (wire-formats 4.1).

mod image;
mod map;

pub use image::SafetyImage;
pub use map::{IMAGE_OBJECTS, InputBits, InputMap};
