//! A depth image as the camera delivers it: whole millimetres, 0 where nothing came back.
//!
//! The pixels stay with whoever received them; an image is a checked view, so no stage has to ask again whether the
//! size fits. What did not come back is unknown, never far away and never floor.

use crate::time::Stamp;

/// A checked view of depth pixels, row by row from the top left. Invariant: `width × height` pixels, both ≥ 1.
#[derive(Clone, Copy, Debug)]
pub struct DepthImage<'a> {
    stamp: Stamp,
    width: usize,
    depth_mm: &'a [u16],
}

/// An image whose pixels and size do not belong together.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct WrongImageSize {
    /// Columns that were announced.
    pub width: usize,
    /// Rows that were announced.
    pub height: usize,
    /// Values that were delivered.
    pub values: usize,
}

impl core::fmt::Display for WrongImageSize {
    fn fmt(&self, formatter: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        write!(
            formatter,
            "an image of {} × {} pixels came with {} values",
            self.width, self.height, self.values
        )
    }
}

impl core::error::Error for WrongImageSize {}

impl<'a> DepthImage<'a> {
    /// A view of `width × height` depths in millimetres along the optical axis, 0 for no return, taken at `stamp`.
    ///
    /// # Errors
    /// The slice has another length, or a side is zero: the frame was cut or belongs to another camera mode. Drop it.
    pub fn new(
        stamp: Stamp,
        (width, height): (usize, usize),
        depth_mm: &'a [u16],
    ) -> Result<Self, WrongImageSize> {
        let is_whole = width > 0 && height > 0 && width.checked_mul(height) == Some(depth_mm.len());
        if is_whole {
            Ok(Self { stamp, width, depth_mm })
        } else {
            Err(WrongImageSize { width, height, values: depth_mm.len() })
        }
    }

    /// When the image was taken.
    #[must_use]
    pub const fn stamp(&self) -> Stamp {
        self.stamp
    }

    /// Columns, ≥ 1.
    #[must_use]
    pub const fn width(&self) -> usize {
        self.width
    }

    /// Rows, ≥ 1.
    #[must_use]
    pub fn height(&self) -> usize {
        self.depth_mm.len().checked_div(self.width).unwrap_or(0)
    }

    /// All depths, millimetres, row by row.
    #[must_use]
    pub const fn depth_mm(&self) -> &'a [u16] {
        self.depth_mm
    }

    /// The rows, from the top.
    pub fn rows(&self) -> core::slice::ChunksExact<'a, u16> {
        self.depth_mm.chunks_exact(self.width.max(1))
    }

    /// How many pixels brought a depth back.
    #[must_use]
    pub fn returns(&self) -> usize {
        // Sixteen bits hold the count of a piece and let compilers count eight pixels at once.
        let count =
            |piece: &[u16]| piece.iter().fold(0_u16, |sum, depth| sum.wrapping_add(u16::from(*depth > 0)));
        self.depth_mm.chunks(4_096).map(|piece| usize::from(count(piece))).sum()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_cut_or_empty_image_is_refused_with_its_size() {
        let pixels = [0_u16, 700, 800, 900, 1_000, 1_100];
        let image = DepthImage::new(Stamp::ZERO, (3, 2), &pixels).unwrap();
        assert_eq!((image.width(), image.height(), image.returns()), (3, 2, 5));
        assert_eq!(image.rows().nth(1), Some([900, 1_000, 1_100].as_slice()));
        for size in [(2, 2), (0, 6), (6, 0), (usize::MAX, 2)] {
            let error = DepthImage::new(Stamp::ZERO, size, &pixels).unwrap_err();
            assert_eq!((error.width, error.height, error.values), (size.0, size.1, 6));
        }
    }
}
