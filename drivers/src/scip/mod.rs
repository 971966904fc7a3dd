//! Two-dimensional lidars that speak SCIP 2.0: Hokuyo URG over a serial line, UST and UTM over TCP (book, SCIP 2.0).
//!
//! ```
//! use floorguard_drivers::scip::{Device, DeviceConfiguration, DeviceEvent};
//! use floorguard_types::time::Stamp;
//!
//! let mut device = Device::new(DeviceConfiguration::URG_04LX);
//! let mut sent = Vec::new();
//! device.poll(Stamp::ZERO, &mut |bytes| sent.extend_from_slice(bytes));
//! assert_eq!(sent, b"SCIP2.0\n");
//! ```

mod clock;
mod command;
mod device;
mod encoding;
mod parameters;
mod receiver;
mod scan;

pub use clock::ScipClock;
pub use command::{COMMAND_BYTES, Command, RangeKind, ScanRange};
pub use device::{Device, DeviceConfiguration, DeviceCounters, DeviceEvent, DevicePhase};
pub use encoding::{check_character, decode_number};
pub use parameters::SensorParameters;
pub use receiver::{Receiver, ReceiverCounters, RefusedReply, Reply, Status};
pub use scan::{MeasuredScan, RawScan, SCIP_BEAMS_MAX};

#[cfg(test)]
mod device_tests;
#[cfg(test)]
mod receiver_tests;
