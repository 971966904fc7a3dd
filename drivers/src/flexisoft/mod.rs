//! The gateway of a SICK Flexi Soft safety controller (wire-formats 4.1).

mod image;

pub use image::{InputBits, InputMap, SafetyImage};
