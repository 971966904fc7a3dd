//! VESC motor controllers by their CAN frames (book, Motor controllers: VESC).
//!
//! From B. Vedder, "VESC CAN-Bus Communication" (`documentation/comm_can.md` of the firmware), sections "Frame Format", "Single-Frame
//! (simple) Commands" and "Status Commands".

mod frame;

pub use frame::{VescMessage, VescOrder, VescReport};

#[cfg(test)]
mod vector_tests;
