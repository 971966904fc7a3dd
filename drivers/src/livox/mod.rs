//! Livox Mid-360: points in any order, gathered into the columns of a lidar that turns ten times a second (book, Livox).
//!
//! The sensor does not turn in columns: its beams wander over all azimuths and elevations and never come back to the same place.

mod decode_error;
mod decoder;
mod gathered;
mod packet;
mod rings;

pub use decode_error::DecodeError;
pub use decoder::{Decoder, DecoderOf};
pub use gathered::{COLUMNS_A_TURN, TURN_US};
pub use packet::{POINTS_MAX, PacketError, Point, PointPacket};
pub use rings::{DEFAULT_ELEVATIONS_MDEG, HIGHEST_MDEG, LOWEST_MDEG};

#[cfg(test)]
mod decoder_tests;
#[cfg(test)]
mod vector_tests;
