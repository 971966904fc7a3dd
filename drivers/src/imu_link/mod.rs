//! Samples of any inertial sensor, from a program beside that reads it (book, IMU link).
//!
//! A sensor whose protocol floorguard does not speak is read by a bridge, which sends its samples in frames: as datagrams, or on a serial
//! line.

mod device;
mod frame;
mod receiver;

pub use device::{Device, DeviceCounters, DeviceEvent, DeviceFault};
pub use frame::{FRAME_BYTES_MAX, FrameError, LinkSample, SAMPLES_MAX, SamplesFrame};
pub use receiver::FrameReceiver;

#[cfg(test)]
mod device_tests;
