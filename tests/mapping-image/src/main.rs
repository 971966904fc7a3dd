//! Mapping on the emulated Cortex-M7: sweeps of a lidar in space, and scans in the plane, of rooms whose walls are met by rays that the
//! image follows itself. It prints what each costs in instructions, and how far off the places are.
#![cfg_attr(target_os = "none", no_std)]
#![cfg_attr(target_os = "none", no_main)]
#![allow(missing_docs)]

#[cfg(target_os = "none")]
mod scans;
#[cfg(target_os = "none")]
mod start;
#[cfg(target_os = "none")]
mod stopwatch;
#[cfg(target_os = "none")]
mod sweeps;

#[cfg(not(target_os = "none"))]
fn main() {
    println!("this image runs on the emulated board: cargo xtask mapping-counts");
}
