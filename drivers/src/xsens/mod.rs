//! Xsens MTi inertial sensors on a serial line: Xbus frames, MTData2, start-up (wire-formats 5).

mod clock;
mod device;
mod frame;
mod item;
mod measurement;

pub use device::{Device, DeviceCounters, DeviceEvent, DevicePhase};
pub use frame::{FrameCounters, FrameReceiver, Message, encode};
pub use item::{Item, Items, NumberFormat};
pub use measurement::{Measurement, MeasurementError, StatusWord};
