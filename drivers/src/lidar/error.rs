//! Why a datagram gives no columns, for the lidars of all makers.

use crate::{hesai, lidar_link, livox, ouster, velodyne};

/// A datagram that gives no columns, or not those of all its blocks.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum LidarError {
    /// Of a Velodyne lidar.
    Velodyne(velodyne::DecodeError),
    /// Of a Hesai lidar.
    Hesai(hesai::DecodeError),
    /// Of an Ouster lidar.
    Ouster(ouster::DecodeError),
    /// Of a bridge.
    Bridged(lidar_link::DecodeError),
    /// Of a Livox.
    Livox(livox::DecodeError),
}

impl LidarError {
    /// The memory of the decoder has changed: nothing that it gives can be trusted.
    #[must_use]
    pub fn is_corruption(&self) -> bool {
        *self == Self::Velodyne(velodyne::DecodeError::Corrupted)
    }

    /// Whether both complain about the same, perhaps with other figures.
    #[must_use]
    pub fn is_alike(&self, other: &Self) -> bool {
        use core::mem::discriminant;
        match (self, other) {
            (Self::Velodyne(one), Self::Velodyne(two)) => discriminant(one) == discriminant(two),
            (Self::Hesai(one), Self::Hesai(two)) => discriminant(one) == discriminant(two),
            (Self::Ouster(one), Self::Ouster(two)) => discriminant(one) == discriminant(two),
            (Self::Bridged(one), Self::Bridged(two)) => discriminant(one) == discriminant(two),
            (Self::Livox(one), Self::Livox(two)) => discriminant(one) == discriminant(two),
            _ => false,
        }
    }
}

impl core::fmt::Display for LidarError {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        match self {
            Self::Velodyne(error) => error.fmt(f),
            Self::Hesai(error) => error.fmt(f),
            Self::Ouster(error) => error.fmt(f),
            Self::Bridged(error) => error.fmt(f),
            Self::Livox(error) => error.fmt(f),
        }
    }
}

impl core::error::Error for LidarError {}
