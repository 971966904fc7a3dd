//! The order in which to visit the cells: a travelling-salesman path that starts at the robot and ends anywhere.

mod cycle;
mod distances;
mod local_search;
mod neighbours;
mod solver;

pub use distances::{Distances, EuclideanCells};
pub use solver::{TourError, TourSolver};
