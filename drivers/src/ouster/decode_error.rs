//! Why a datagram gives no columns.

use super::packet::PacketError;

/// A datagram that gives no columns.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum DecodeError {
    /// It is no lidar packet of this sensor.
    Packet(PacketError),
    /// Its times do not rise, or by more than a column of the slowest head takes.
    Times {
        /// From the first column to the last, microseconds.
        took_us: u32,
    },
    /// None of its columns was measured.
    NothingMeasured,
    /// Not newer than the packet before: repeated or overtaken.
    NotNewer {
        /// Number of the turn.
        frame: u16,
        /// First column of the packet.
        column: u16,
    },
}

impl core::fmt::Display for DecodeError {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        match self {
            Self::Packet(error) => write!(f, "{error}"),
            Self::Times { took_us } => {
                write!(
                    f,
                    "the lidar's packet took {took_us} us; the motor turns too slowly, or its clock was set"
                )
            }
            Self::NothingMeasured => write!(f, "lidar packet without one measured column"),
            Self::NotNewer { frame, column } => {
                write!(f, "lidar packet of turn {frame}, column {column} is not newer than the one before")
            }
        }
    }
}

impl core::error::Error for DecodeError {}
