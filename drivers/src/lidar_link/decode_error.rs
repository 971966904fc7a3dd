//! Why a datagram gives no columns.

use super::frame::FrameError;

/// A datagram that gives no columns.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum DecodeError {
    /// It is none of columns.
    Frame(FrameError),
    /// It has other rings than the robot's file names elevations for.
    Rings {
        /// Its rings.
        found: u8,
        /// Elevations of the robot's file.
        expected: u8,
    },
    /// Another sender than the one that was understood first.
    Sender {
        /// Who sent it.
        found: u32,
        /// Who is listened to.
        expected: u32,
    },
    /// Not newer than the datagram before: repeated or overtaken.
    NotNewer {
        /// Its sequence.
        sequence: u32,
    },
}

impl core::fmt::Display for DecodeError {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        match self {
            Self::Frame(error) => write!(f, "{error}"),
            Self::Rings { found, expected } => {
                write!(
                    f,
                    "lidar datagram of {found} rings; `elevations_deg` of this robot's file has {expected}"
                )
            }
            Self::Sender { found, expected } => {
                write!(
                    f,
                    "lidar datagram of sender {found}; sender {expected} is listened to: end one of the two bridges"
                )
            }
            Self::NotNewer { sequence } => {
                write!(f, "lidar datagram {sequence} is not newer than the one before")
            }
        }
    }
}

impl core::error::Error for DecodeError {}
