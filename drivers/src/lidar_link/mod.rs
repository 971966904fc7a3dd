//! Columns of any lidar, from a program beside that reads it (book, Lidar link).
//!
//! A lidar whose protocol floorguard does not speak is read by a bridge, which sends what each column measured as a datagram.

mod decode_error;
mod decoder;
mod frame;

pub use decode_error::DecodeError;
pub use decoder::{Decoder, DecoderOf};
pub use frame::{Column, ColumnsFrame, FrameError, RINGS_MAX};

#[cfg(test)]
mod decoder_tests;
