//! A picture with its truth.

use floorguard_types::sensing::ImageSize;

use super::kinds::DirtKind;

/// Colour of the line that a safety projector draws on the floor.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum MarkingColour {
    /// Red laser.
    Red,
    /// Green laser.
    Green,
}

/// When a picture is taken.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PictureMoment {
    /// Number of the picture; its noise follows from it.
    pub frame: u32,
    /// Since the lamps were switched on, seconds: some flicker, and shadows move.
    pub at_s: f32,
}

/// A rendered picture and what is on each of its pixels.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct FloorPicture {
    /// Columns and rows.
    pub size: ImageSize,
    /// Red, green, blue, row by row.
    pub rgb: Vec<u8>,
    /// The kind of dirt of each pixel.
    pub dirt: Vec<Option<DirtKind>>,
    /// True where a pixel looks at floor within reach.
    pub is_floor: Vec<bool>,
    /// True where the safety projector marks the floor.
    pub is_marking: Vec<bool>,
}

impl FloorPicture {
    /// Pixels that a detector may judge: floor without marking.
    #[must_use]
    pub fn usable(&self) -> Vec<bool> {
        self.is_floor.iter().zip(&self.is_marking).map(|(floor, marking)| *floor && !*marking).collect()
    }
}
