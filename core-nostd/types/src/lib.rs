//! Values that every part of the robot's software shares: geometry, time, units, what sensors deliver, fixed sizes.
//!
//! No heap, no clock, no I/O, no `unsafe`, no panic. Time is an argument, exceeding a capacity is a value, and "no
//! data" is never "no obstacle".
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

pub mod capacities;
pub mod geometry;
pub mod motion;
pub mod number;
pub mod profile;
pub mod random;
pub mod sensing;
pub mod time;
pub mod united_parts;
pub mod units;
