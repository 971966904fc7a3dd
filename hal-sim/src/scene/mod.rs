//! What stands still: floor, walls, shelves, tables, trolleys, glass and mirrors, ramps.

mod builder;
mod file;
mod material;
mod occupied;
mod scene3;

pub use builder::SceneBuilder;
pub use file::{FurnitureKind, MapFile, SceneFile};
pub use material::Material;
pub use occupied::OccupiedCells;
pub use scene3::{Hit, Scene};
