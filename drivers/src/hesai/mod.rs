//! Hesai PandarXT-16 and XT-32: bytes of a datagram in, columns of a sweep out.
//!
//! Source of formats, angles and times: book, Hesai.

mod decode_error;
mod decoder;
mod packet;

pub use decode_error::DecodeError;
pub use decoder::{Counters, Decoder, DecoderOf};
pub use packet::{Block, Packet, PacketError, ReturnMode};

#[cfg(test)]
mod decoder_tests;
