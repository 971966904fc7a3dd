//! Scans of any scanner, from a program beside that reads it (book, Scan link).
//!
//! A scanner whose protocol floorguard does not speak is read by a bridge, which sends what its beams measured as one or more datagrams
//! a scan. It is no safety device, whatever stands before the bridge: what goes through a program is not certified.

mod decode_error;
mod decoder;
mod frame;
mod shape;

pub use decode_error::{DecodeError, ShapePart};
pub use decoder::{Decoder, DecoderOf, ScanCounters};
pub use frame::{BEAMS_MAX, BeamsFrame, FRAGMENT_BEAMS, FrameError, ScanHead};
pub use shape::ScanShape;

#[cfg(test)]
mod damage_tests;
#[cfg(test)]
mod decoder_tests;
