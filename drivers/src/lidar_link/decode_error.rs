//! Why a datagram gives no columns.

use super::frame::FrameError;
use crate::link::OrderError;

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
    /// It is another sender's, or out of order.
    Order(OrderError),
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
            Self::Order(error) => write!(f, "lidar datagram of {error}"),
        }
    }
}

impl core::error::Error for DecodeError {}
