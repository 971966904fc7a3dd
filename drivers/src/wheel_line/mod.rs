//! Speeds of wheels on a plain serial line, for custom motor controllers (book, Motor controllers: Wheel line): text, a sequence, a checksum,
//! and a deadline after which the controller stops by itself. `examples/wheel_line.py` is the reference.

mod line;

pub use line::{
    LINE_WHEELS_MAX, WheelLineError, WheelReport, WheelRequest, WheelState, WheelValue, WheelValues,
};

#[cfg(test)]
mod vector_tests;
