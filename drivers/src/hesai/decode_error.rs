//! Why a datagram gives no columns.

use super::packet::PacketError;

/// A datagram that gives no columns.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum DecodeError {
    /// It is no data packet.
    Packet(PacketError),
    /// The lidar has more lasers than the capacity of this build or [`super::DecoderOf::with_lasers_max`] allow.
    TooManyLasers {
        /// Lasers of the lidar.
        lasers: u8,
        /// As many are taken.
        lasers_max: u8,
    },
    /// The head does not turn, or azimuths jump more than once in a packet.
    Rotation {
        /// From a block to the next, hundredths of a degree.
        gap_cdeg: u16,
    },
    /// Two echoes, but the blocks of a pair have different azimuths.
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
}

impl core::fmt::Display for DecodeError {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        match self {
            Self::Packet(error) => write!(f, "{error}"),
            Self::TooManyLasers { lasers, lasers_max } => {
                write!(f, "a lidar of {lasers} lasers, {lasers_max} are taken here")
            }
            Self::Rotation { gap_cdeg } => write!(
                f,
                "the lidar turned {gap_cdeg} cdeg from a block to the next; possible are 1 to 100: is the motor running?"
            ),
            Self::NoPairs { first_cdeg, second_cdeg } => write!(
                f,
                "two returns, but the blocks of a pair have azimuths {first_cdeg} and {second_cdeg} cdeg; expected the same"
            ),
            Self::NotNewer { stamp_us } => {
                write!(f, "lidar packet {stamp_us} us is not newer than the one before")
            }
        }
    }
}

impl core::error::Error for DecodeError {}
