//! What the sensors show: people, legs, people in depth pictures, what moves by itself, the floor, learning on the spot.
//!
//! No heap, no clock, no I/O, no `unsafe`, no panic. What is found here can only tighten what the guard permits.
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

pub mod any_scanner;
pub mod clusters;
pub mod floor;
pub mod legs;
pub mod motion;
pub mod online_learning;
pub mod people;
pub mod rgbd_people;
pub mod shapes;
pub mod tracking;
