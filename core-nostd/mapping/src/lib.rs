//! Maps of the floor: what is occupied, how far the nearest obstacle is, and how much dirt is expected where.
//!
//! A map never allocates. Its storage is handed in: an array of fixed size on the target (`FixedGrid`), a boxed slice
//! on a Linux computer.
//!
#![doc = include_str!("../README.md")]
#![no_std]
#![forbid(unsafe_code)]
#![cfg_attr(
    not(test),
    deny(
        clippy::unwrap_used,
        clippy::expect_used,
        clippy::panic,
        clippy::unreachable,
        clippy::todo,
        clippy::unimplemented,
        clippy::indexing_slicing,
        clippy::as_conversions
    )
)]

#[cfg(test)]
extern crate std;

mod dirt_map;
mod dirt_rate;
mod distance_field;
mod distance_transform;
pub mod environment;
mod grid;
pub mod lidar_odometry;
pub mod match_field;
mod occupancy;
pub mod people_removal;
mod poisson;
mod rolling;
pub mod seen_dirt;
pub mod sliding_window;

pub use dirt_map::{DirtCell, DirtMap, NO_SLOT};
pub use dirt_rate::{DirtRate, RunObservation, attribute_hits, observed_share};
pub use distance_field::{DISTANCE_LIMIT_M, DistanceField, fill_distances};
pub use distance_transform::{NO_OBSTACLE, Parabola, squared_distances};
pub use grid::{
    FixedGrid, GRID_CELLS_MAX, GRID_SIDE_MAX, Grid, GridCoordinates, GridGeometry, GridSides, GridTooSmall,
};
pub use occupancy::Occupancy;
pub use poisson::{negative_binomial_quantile, poisson_cdf, poisson_quantile, poisson_tail, threshold_rate};
pub use rolling::GridShift;
