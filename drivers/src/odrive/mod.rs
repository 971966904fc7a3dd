//! ODrive motor controllers by CAN Simple, firmware 0.6 (book, Motor controllers: ODrive).
//!
//! From ODrive Robotics, "CAN Protocol" of the documentation of firmware 0.6, section "CAN Messages", and the DBC file beside it.

mod frame;

pub use frame::{AxisState, OdriveMessage, OdriveOrder, OdriveReport, WATCHDOG_EXPIRED};

#[cfg(test)]
mod vector_tests;
