//! Firmware for QEMU's `mps2-an500`, a Cortex-M7 at 25 MHz.
//!
//! The same tasks as on the robot's Linux computer, on executors that sleep until an interrupt. Nothing here has run
//! on silicon: the board exists to run the product's code on the target's instruction set in every CI run.
#![cfg_attr(target_os = "none", no_std)]
#![cfg_attr(target_os = "none", no_main)]
#![allow(missing_docs)]

#[cfg(target_os = "none")]
mod clock;
#[cfg(target_os = "none")]
mod crash_record;
#[cfg(target_os = "none")]
mod ethernet;
#[cfg(target_os = "none")]
mod executor;
#[cfg(target_os = "none")]
mod faults;
#[cfg(target_os = "none")]
mod interrupts;
#[cfg(target_os = "none")]
mod log;
#[cfg(target_os = "none")]
mod register;
#[cfg(target_os = "none")]
mod robot;
#[cfg(target_os = "none")]
mod stack_guard;
#[cfg(target_os = "none")]
mod start;
#[cfg(target_os = "none")]
mod uart;
#[cfg(target_os = "none")]
mod watchdog;
#[cfg(target_os = "none")]
mod wired;

#[cfg(not(target_os = "none"))]
fn main() {
    println!("this is firmware; run it with: cargo xtask firmware");
}
