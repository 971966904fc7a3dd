//! A depth image as the camera delivers it: whole millimetres, 0 where nothing came back.
//!
//! The pixels stay with their receiver; an image is a checked view, so no stage has to ask again whether the size
//! fits. What did not come back is unknown, never far away and never floor.

use super::frame_watch::fingerprint;
use super::image_size::{ImageSize, WrongImageSize};
use super::stamped_image::StampedImage;
use crate::time::Stamp;

/// A checked view of depth pixels, row by row from the top left. Invariant: `width × height` pixels, both ≥ 1.
///
/// ```
/// use floorguard_types::{sensing::{DepthImage, ImageSize}, time::Stamp};
///
/// let depth_mm = [0, 700, 800, 900, 1_000, 1_100];
/// let image = DepthImage::new(Stamp::ZERO, ImageSize { width: 3, height: 2 }, &depth_mm).unwrap();
/// assert_eq!((image.width(), image.height(), image.returns()), (3, 2, 5));
/// // A frame that was cut is refused, and the error tells the numbers.
/// let error = DepthImage::new(Stamp::ZERO, ImageSize { width: 3, height: 2 }, &depth_mm[..4]).unwrap_err();
/// assert_eq!(error.to_string(), "an image of 3 × 2 pixels came with 4 values");
/// ```
pub type DepthImage<'a> = StampedImage<'a, u16>;

impl<'a> DepthImage<'a> {
    /// A view of depths in millimetres along the optical axis, 0 for no return, taken at `stamp`.
    ///
    /// # Errors
    /// The slice has another length, or a side is zero: the frame was cut or belongs to another camera mode. Drop it.
    pub fn new(stamp: Stamp, size: ImageSize, depth_mm: &'a [u16]) -> Result<Self, WrongImageSize> {
        Self::of(stamp, size, (depth_mm, depth_mm.len()))
    }

    /// All depths, millimetres, row by row.
    #[must_use]
    pub const fn depth_mm(&self) -> &'a [u16] {
        self.pixels()
    }

    /// How many pixels brought a depth back.
    #[must_use]
    pub fn returns(&self) -> usize {
        // Sixteen bits hold the count of a piece and let compilers count eight pixels at once.
        let count =
            |piece: &[u16]| piece.iter().fold(0_u16, |sum, depth| sum.wrapping_add(u16::from(*depth > 0)));
        self.depth_mm().chunks(4_096).map(|piece| usize::from(count(piece))).sum()
    }
}

impl DepthImage<'_> {
    /// A number that differs where two images do in one of every 16th pixels.
    #[must_use]
    pub fn fingerprint(&self) -> u64 {
        fingerprint(self.depth_mm().iter().step_by(16).map(|depth| u64::from(*depth)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn cut_or_empty_image_is_refused() {
        let pixels = [0_u16, 700, 800, 900, 1_000, 1_100];
        let image = DepthImage::new(Stamp::ZERO, ImageSize { width: 3, height: 2 }, &pixels).unwrap();
        assert_eq!((image.width(), image.height(), image.returns()), (3, 2, 5));
        assert_eq!(image.rows().nth(1), Some([900, 1_000, 1_100].as_slice()));
        for (width, height) in [(2, 2), (0, 6), (6, 0), (usize::MAX, 2)] {
            let error = DepthImage::new(Stamp::ZERO, ImageSize { width, height }, &pixels).unwrap_err();
            assert_eq!(error, WrongImageSize { width, height, values: 6 });
        }
    }
}
