//! Xsens MTi inertial sensors on a serial line: Xbus frames, MTData2, start-up (book, Xsens MTi).

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
