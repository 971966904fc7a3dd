//! Velodyne lidars: VLP-16 and LITE, Puck Hi-Res, VLP-32C, HDL-32E. Bytes of a datagram in, columns of a sweep out.
//!
//! Source of formats, angles and times: book, Velodyne.

mod clock;
mod closed_sector;
mod columns;
mod decode_error;
mod decoder;
mod gprmc;
mod model;
mod packet;
mod people_rings;
mod position;
mod returns;
mod rotation;
mod sweep_builder;

pub use clock::HourClock;
pub use closed_sector::ClosedSector;
pub use decode_error::DecodeError;
pub use decoder::{Counters, Decoder, DecoderOf, ModelChoice};
pub use gprmc::{Gprmc, GprmcError, Place};
pub use model::{LaserAngles, Model, NativeAngles, detect_model};
pub use packet::{BlockTurn, Packet, PacketError, ReturnMode};
pub use position::{BoardTemperatures, PositionError, PositionPacket, PpsState};
pub use returns::{Return, Returns, ReturnsOf};
pub use sweep_builder::SweepBuilder;

#[cfg(test)]
mod blocks_tests;
#[cfg(test)]
mod closed_sector_tests;
#[cfg(test)]
mod decoder_tests;
#[cfg(test)]
mod sweep_builder_tests;
#[cfg(test)]
mod vector_tests;
