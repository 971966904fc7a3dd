//! Where something stands and where the floor is free, by the beams of all kept scans.
//!
//! Source: hits and passes of cells as the karto mapper counts them (Konolige et al. 2010). A beam without a return says
//! nothing here: no return is not free floor.

mod build;
mod counts;
mod edit;
mod grid;

pub use build::{GridMapConfig, build_grid_map};
pub use counts::{CellCounts, CountGrid};
pub use edit::Zone;
pub use grid::GridMap;
