//! Translates: bytes of the wire into typed measurements, and typed commands into bytes.
//!
//! Sans-I/O codecs and device state machines. Every decoder is total: any bytes in, a typed value or a typed error
//! out, no panic, no over-read, and it resynchronises. Nothing here reads a clock; arrival times are arguments.
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

pub mod can;
pub mod canopen;
pub mod cia402;
pub mod cia406;
pub mod cola;
mod datagram_counters;
pub mod discrete_inputs;
pub mod flexisoft;
pub mod hesai;
pub mod imu_link;
pub mod inertial;
pub mod lidar;
pub mod lidar_link;
mod link;
pub mod livox;
pub mod microscan3;
pub mod motor_drives;
pub mod odrive;
pub mod ouster;
pub mod ranging;
pub mod roboteq;
pub mod rplidar;
pub mod s300;
pub mod scan_link;
pub mod scan_motor;
pub mod scip;
mod second_rings;
pub mod text_lines;
pub mod three_wheel_base;
pub mod vectornav;
pub mod velocity_link;
pub mod velodyne;
pub mod vesc;
pub mod wheel_drives;
pub mod wheel_line;
pub mod xsens;

pub use datagram_counters::DatagramCounters;
pub use link::OrderError;

#[cfg(test)]
mod words_tests;
