//! Why a datagram gives no columns.

use super::model::Model;
use super::packet::PacketError;

/// A datagram that gives no columns.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum DecodeError {
    /// It is no data packet.
    Packet(PacketError),
    /// It comes from another model than configured.
    WrongModel {
        /// As configured.
        configured: Model,
        /// As the packet says.
        product_byte: u8,
        /// Microseconds since the packet before, where that tells.
        period_us: Option<u32>,
    },
    /// Product byte 0x21 without a second packet yet: early VLP-16 or HDL-32E. Happens once after the start.
    ModelUndecided,
    /// A product byte that no supported model has.
    UnknownProduct {
        /// The byte.
        product_byte: u8,
    },
    /// The lidar has more lasers than the capacity of this build or [`Decoder::with_lasers_max`] allow.
    TooManyLasers {
        /// Which one sends.
        model: Model,
        /// As many are taken.
        lasers_max: u8,
    },
    /// The head does not turn, or turns impossibly fast: azimuths cannot be trusted.
    Rotation {
        /// Turned within one block, hundredths of a degree.
        gap_cdeg: u16,
    },
    /// A dual-return packet whose blocks do not come in pairs of one azimuth: times and azimuths would be wrong.
    NoPairs {
        /// Azimuth of the first block of the pair, hundredths of a degree.
        first_cdeg: u16,
        /// Of the second.
        second_cdeg: u16,
    },
    /// Not newer than the packet before: repeated or overtaken.
    NotNewer {
        /// Microseconds since the top of the hour.
        stamp_us: u32,
    },
    /// Model or order of the rings differ from their copy: a flipped bit in the memory of the decoder (FG-REQ-058).
    Corrupted,
}

impl core::fmt::Display for DecodeError {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        match self {
            Self::Packet(error) => write!(f, "{error}"),
            Self::WrongModel { configured, product_byte, period_us } => {
                write!(f, "the lidar is no {}: product byte 0x{product_byte:02X}", configured.name())?;
                if let Some(period_us) = period_us {
                    write!(f, ", {period_us} us between packets (expected {})", configured.packet_us(false))?;
                }
                write!(f, "; set the model to auto or to the one that is mounted")
            }
            Self::ModelUndecided => {
                write!(f, "product byte 0x21 is an HDL-32E or an early VLP-16; one more packet tells")
            }
            Self::UnknownProduct { product_byte } => {
                write!(f, "unknown lidar product byte 0x{product_byte:02X}; set the model by hand")
            }
            Self::TooManyLasers { model, lasers_max } => {
                write!(f, "a {} has {} lasers, {lasers_max} are taken here", model.name(), model.lasers())
            }
            Self::Rotation { gap_cdeg } => {
                write!(
                    f,
                    "the lidar turned {gap_cdeg} cdeg within a block; possible are 1 to 100: is the motor running?"
                )
            }
            Self::NoPairs { first_cdeg, second_cdeg } => {
                write!(
                    f,
                    "dual return, but the blocks of a pair have azimuths {first_cdeg} and {second_cdeg} cdeg; \
                     expected the same"
                )
            }
            Self::NotNewer { stamp_us } => {
                write!(f, "lidar packet {stamp_us} us is not newer than the one before")
            }
            Self::Corrupted => write!(f, "the decoder's memory has changed; restart the robot"),
        }
    }
}

impl core::error::Error for DecodeError {}
