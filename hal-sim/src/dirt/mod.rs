//! Dirt on the floor as it really lies there, the brush that picks it up, and the sensor that counts it.

mod file;
mod floor;
mod sensor;

pub(crate) use file::raster_of;
pub use file::{DirtFile, DirtyPatch, SpillFile};
pub use floor::DirtyFloor;
pub use sensor::DirtSensor;
