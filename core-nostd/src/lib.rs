//! Decides: perception, guard, cleaning. Pure functions of their arguments and of fixed-size state.
//!
//! No heap, no clock, no I/O, no `unsafe`, no panic. Time is an argument, running out of room is a value, and
//! "no data" is never "no obstacle".
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
        clippy::indexing_slicing
    )
)]

#[cfg(test)]
extern crate std;

pub mod capacities;
pub mod cleaning;
pub mod floor;
pub mod geometry;
pub mod guard;
pub mod legs;
pub mod maps;
pub mod motion;
pub mod odometry;
pub mod online_learning;
pub mod people;
pub mod protection;
pub mod random;
pub mod rgbd_people;
pub mod sensing;
pub mod time;
mod united_parts;
pub mod units;
