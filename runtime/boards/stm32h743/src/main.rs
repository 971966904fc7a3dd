//! Firmware for a Nucleo-H743ZI2: the robot's tasks on the devices of the chip.
//!
//! Never run on hardware; see the README beside it.
#![no_std]
#![no_main]
#![allow(missing_docs)]

mod can;
mod clocks;
mod guard_ring;
mod inputs;
mod network;
mod serial;
mod start;
