//! A colour picture.

/// Eight bits for red, green and blue each. Invariant: three octets a pixel, neither side 0.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct RgbPicture {
    size: [u32; 2],
    octets: Vec<u8>,
}

/// The octets are not those of a picture of this size.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{octets} octets are no colour picture of {}×{} pixels", size[0], size[1])]
pub struct SizeError {
    /// Width and height, pixels.
    pub size: [u32; 2],
    /// Given.
    pub octets: usize,
}

impl RgbPicture {
    /// Row by row from the upper left corner.
    ///
    /// # Errors
    /// Another number of octets, or a side of 0.
    pub fn new(size: [u32; 2], octets: Vec<u8>) -> Result<Self, SizeError> {
        let [width, height] = size.map(|side| side as usize);
        let is_whole = width > 0 && height > 0 && width.checked_mul(height * 3) == Some(octets.len());
        if is_whole { Ok(Self { size, octets }) } else { Err(SizeError { size, octets: octets.len() }) }
    }

    /// Width and height, pixels.
    #[must_use]
    pub const fn size(&self) -> [u32; 2] {
        self.size
    }

    /// Red, green, blue of a pixel; the nearest one for places outside.
    #[must_use]
    pub fn at(&self, column: i64, row: i64) -> [u8; 3] {
        let [width, height] = self.size.map(i64::from);
        let (column, row) = (column.clamp(0, width - 1), row.clamp(0, height - 1));
        let from = 3 * (row * width + column) as usize;
        [self.octets[from], self.octets[from + 1], self.octets[from + 2]]
    }
}
