//! Two-dimensional scanners that are no safety devices: one contract over the makers' protocols (book, Ranging scanners).
//!
//! They measure as safety scanners do, and nothing more: no output is certified, no window is tested, no return is warranted. What they
//! do not report is unknown: never free.

mod any_scanner;
mod bridged;
mod contract;
mod hokuyo;
mod rplidar;
mod sick;

pub use any_scanner::{AnyRangingScanner, AnyRangingScannerOf};
pub use bridged::{Bridged, BridgedOf};
pub use contract::{RangingEvent, RangingScanner};
pub use hokuyo::{Hokuyo, HokuyoOf, URG_04LX_FULL, UST_FULL};
pub use rplidar::{RPLIDAR_A, RPLIDAR_S, Rplidar, RplidarConfiguration, RplidarOf};
pub use sick::{Cola, ColaConfiguration, ColaOf, LMS1XX, TIM5XX};

#[cfg(test)]
mod rplidar_tests;
#[cfg(test)]
mod sick_tests;
