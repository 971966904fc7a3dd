//! Which path the robot takes: search on a grid, and following what was found.
//!
//! No heap, no clock, no I/O, no `unsafe`, no panic.
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

pub mod costmap;
pub mod docking;
pub mod explore;
pub mod global;
pub mod local;
pub mod path;
mod path_search;
pub mod prediction;
pub mod recovery;
pub mod route;

pub use path::{FollowConfig, Following, Stretch, follow};
pub use path_search::{PathSearch, SEARCH_CELLS_MAX, STRAIGHT, SearchCell};
