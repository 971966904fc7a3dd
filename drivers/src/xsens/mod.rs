//! Xsens MTi inertial sensors on a serial line: Xbus frames, MTData2, start-up (book, Xsens MTi).
//!
//! ```
//! use floorguard_drivers::xsens::{Device, DevicePhase, encode};
//! use floorguard_types::time::Stamp;
//!
//! // Ask for configuration; the device acknowledges, then it is asked who it is.
//! let mut device = Device::new(115_200);
//! let mut sent = Vec::new();
//! device.poll(Stamp::ZERO, &mut |frame| sent.extend_from_slice(frame));
//! assert_eq!(sent, [0xFA, 0xFF, 0x30, 0x00, 0xD1]);
//! device.push(&encode(0x31, &[]).unwrap(), Stamp::from_micros(9_000), |_| {});
//! assert_eq!(device.phase(), DevicePhase::Identifying);
//! ```

mod clock;
mod configuration;
mod device;
mod frame;
mod item;
mod measurement;
mod start_up;

pub use configuration::DeviceConfiguration;
pub use device::{Device, DeviceCounters, DeviceEvent, DeviceFault};
pub use frame::{FrameCounters, FrameReceiver, Message, encode};
pub use item::{Item, Items, LocalFrame, NumberFormat, Overrun};
pub use measurement::{Measurement, MeasurementError, NoRotation, StatusWord, UtcTime};
pub use start_up::DevicePhase;

#[cfg(test)]
mod device_tests;
#[cfg(test)]
mod measurement_tests;
