//! How a surface answers a laser.

use serde::{Deserialize, Serialize};

/// Surface of a part of the scene.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Material {
    /// Paint, wood, cloth, cardboard.
    #[default]
    Matte,
    /// Black rubber or velvet: seen only from near.
    Dark,
    /// Lets the beam through except at right angles.
    Glass,
    /// Throws the beam on.
    Mirror,
    /// Reflector of a safety vest or a bumper.
    Retro,
}

impl Material {
    /// Calibrated reflectivity of the VLP-16's scale: 0…100 diffuse, above retro-reflective (book, Velodyne: Data
    /// packet).
    #[must_use]
    pub const fn reflectivity(self) -> u8 {
        match self {
            Self::Matte => 45,
            Self::Dark => 4,
            Self::Glass => 8,
            Self::Mirror => 12,
            Self::Retro => 220,
        }
    }
}
