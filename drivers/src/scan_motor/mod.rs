//! The motor that turns a lidar back and forth: a CiA 402 drive in profile velocity, as a Maxon EPOS (book, CANopen: CiA 402
//! drives; book, SCIP 2.0: Motor).
//!
//! ```
//! use floorguard_drivers::scan_motor::{ScanMotor, ScanMotorConfiguration};
//! use floorguard_types::time::Stamp;
//!
//! let mut motor = ScanMotor::new(ScanMotorConfiguration::PUBLISHED);
//! let mut sent = Vec::new();
//! motor.poll(Stamp::ZERO, &mut |_| {}, &mut |frame| sent.push(*frame));
//! // Nobody was heard yet: the node is called.
//! assert_eq!(sent[0].payload(), [0x40, 0x17, 0x10, 0, 0, 0, 0, 0]);
//! ```

mod configuration;
mod motor;

pub use configuration::ScanMotorConfiguration;
pub use motor::{ScanMotor, ScanMotorCounters, ScanMotorEvent, ScanMotorFault};

#[cfg(test)]
mod motor_tests;
