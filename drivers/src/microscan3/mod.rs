//! SICK microScan3, outdoorScan3 and nanoScan3: measured data over UDP (book, microScan3).
//!
//! The device talks, the host listens. Safety must not depend on this channel alone; the device's own cut-off paths are
//! the safety channel.

mod assembler;
mod blocks;
mod configuration;
mod fragment;
mod message;
mod receiver;

pub use assembler::{AssemblyCounters, MESSAGE_BYTES_MAX};
pub use blocks::{BeamStatus, DeviceStatus, Geometry, Intrusion, Measured};
pub use configuration::Configuration;
pub use fragment::{Fragment, FragmentError};
pub use message::{Message, MessageError};
pub use receiver::{Counters, Event, EventOf, Receiver, ReceiverOf, ScanError};

#[cfg(test)]
mod blocks_tests;
#[cfg(test)]
mod receiver_tests;
#[cfg(test)]
mod vector_tests;
