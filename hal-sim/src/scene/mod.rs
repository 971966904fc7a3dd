//! What stands still: floor, walls, shelves, tables, trolleys, glass and mirrors, ramps.

mod area;
mod builder;
mod file;
mod material;
mod occupied;
mod part;
mod scene3;

pub use area::distance_to_area;
pub use builder::SceneBuilder;
pub use file::{DropFile, FurnitureFile, FurnitureKind, MapFile, SceneFile, WallFile};
pub use material::Material;
pub use occupied::OccupiedCells;
pub use part::{DropTruth, PartShape, PartTruth};
pub use scene3::{Hit, Scene};
