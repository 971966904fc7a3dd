//! Floors as a camera sees them: textures, dirt on them, lamps, shadows, and the camera itself.
//!
//! Every picture follows from a seed, and with it comes the truth: which pixels show dirt, floor, laser marking. The
//! dirt lies in the world, so it stays where it is while the camera moves; lamp reflections do not.

mod camera;
mod kinds;
mod light;
mod noise;
mod picture;
mod scene;
mod spill;
mod texture;

pub use camera::FloorCamera;
pub use kinds::{DirtKind, FloorKind};
pub use light::{Lamp, Lighting, Shadow};
pub use picture::{FloorPicture, MarkingColour, PictureMoment};
pub use scene::FloorScene;
pub use spill::Spill;
