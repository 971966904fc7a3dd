//! VectorNav inertial sensors on a serial line: VN-100, VN-200, VN-300 and their kin (book, VectorNav).
//!
//! ```
//! use floorguard_drivers::vectornav::{Device, DevicePhase, sentence};
//! use floorguard_types::time::Stamp;
//!
//! // Asked to be quiet; once it is, it is asked who it is.
//! let mut device = Device::new(115_200);
//! let mut sent = Vec::new();
//! device.poll(Stamp::ZERO, &mut |bytes| sent.extend_from_slice(bytes));
//! assert_eq!(sent, b"$VNASY,0*4F\r\n");
//! device.push(&sentence(b"VNASY,0").unwrap(), Stamp::from_micros(9_000), |_| {});
//! assert_eq!(device.phase(), DevicePhase::Naming);
//! ```

mod device;
mod line;
mod measurement;
mod start_up;

pub use device::{Device, DeviceCounters, DeviceEvent, DeviceFault};
pub use line::{LineCounters, LineReceiver, Message, SENTENCE_MAX, sentence};
pub use measurement::{FRAME_BYTES, HEADER, Measurement, NotFinite};
pub use start_up::DevicePhase;

#[cfg(test)]
mod device_tests;
#[cfg(test)]
mod line_tests;
