//! Ouster OS0, OS1 and OS2: bytes of a datagram in, columns of a sweep out.
//!
//! Source of formats, angles and times: book, Ouster.

mod beams;
mod decode_error;
mod decoder;
mod packet;
mod staggered;

pub use beams::{Beams, CHANNELS_MAX, DataFormat, SPREAD_MAX};
pub use decode_error::DecodeError;
pub use decoder::{Counters, Decoder, DecoderOf};
pub use packet::{Column, Packet, PacketError};

#[cfg(test)]
mod decoder_tests;
#[cfg(test)]
mod vector_tests;
