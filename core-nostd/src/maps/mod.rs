//! Maps of the floor: what is occupied, how far the nearest obstacle is, and how much dirt is expected where.
//!
//! A map never allocates. Its storage is handed in: an array of fixed size on the target (`FixedGrid`), a boxed slice
//! on a Linux computer.

mod dirt_map;
mod distance_field;
pub mod environment;
mod grid;
mod occupancy;
pub mod seen_dirt;

pub use dirt_map::{DirtCell, DirtMap, NO_SLOT};
pub use distance_field::{DISTANCE_LIMIT_M, DistanceField, fill_distances};
pub use grid::{FixedGrid, Grid, GridGeometry, GridTooSmall};
pub use occupancy::Occupancy;
