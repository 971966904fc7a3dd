//! Why a datagram gives no columns.

use super::packet::PacketError;

/// A datagram that gives no columns.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum DecodeError {
    /// It is none of points.
    Packet(PacketError),
    /// Not newer than the datagram before: repeated or overtaken.
    NotNewer {
        /// By how much it is older, microseconds.
        older_us: u32,
    },
    /// Points of less than a turn have come since the sensor began: not yet in every direction.
    Gathering,
}

impl core::fmt::Display for DecodeError {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        match self {
            Self::Packet(error) => write!(f, "{error}"),
            Self::NotNewer { older_us } => {
                write!(f, "lidar datagram is {older_us} us older than the one before: left out")
            }
            Self::Gathering => write!(f, "the lidar begins: its points of the first 0.1 s are gathered"),
        }
    }
}

impl core::error::Error for DecodeError {}
