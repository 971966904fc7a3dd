//! A colour image as the camera delivers it: three bytes a pixel, sRGB.

use super::frame_watch::fingerprint;
use super::image_size::{ImageSize, WrongImageSize};
use super::stamped_image::StampedImage;
use crate::time::Stamp;

/// A checked view of colour pixels, row by row from the top left. Invariant: `width × height` pixels, both ≥ 1.
///
/// ```
/// use floorguard_types::{sensing::{ColorImage, ImageSize}, time::Stamp};
///
/// let rgb = [255, 0, 0, 0, 0, 255];
/// let image = ColorImage::new(Stamp::ZERO, ImageSize { width: 2, height: 1 }, &rgb).unwrap();
/// assert_eq!(image.pixels(), [[255, 0, 0], [0, 0, 255]]);
/// ```
pub type ColorImage<'a> = StampedImage<'a, [u8; 3]>;

impl<'a> ColorImage<'a> {
    /// A view of pixels of red, green, blue, taken at `stamp`.
    ///
    /// # Errors
    /// The slice has another length, or a side is zero: the frame was cut or belongs to another camera mode. Drop it.
    pub fn new(stamp: Stamp, size: ImageSize, rgb: &'a [u8]) -> Result<Self, WrongImageSize> {
        let (pixels, rest) = rgb.as_chunks::<3>();
        let (ImageSize { width, height }, values) = (size, rgb.len());
        if !rest.is_empty() {
            return Err(WrongImageSize { width, height, values });
        }
        Self::of(stamp, size, (pixels, values))
    }
}

impl ColorImage<'_> {
    /// A number that differs where two images do in one of every 16th pixels.
    #[must_use]
    pub fn fingerprint(&self) -> u64 {
        let values = self.pixels().iter().step_by(16);
        fingerprint(values.map(|[r, g, b]| u64::from(u32::from_le_bytes([*r, *g, *b, 0]))))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_cut_image_is_refused() {
        let rgb = [1, 2, 3, 4, 5, 6];
        let image = ColorImage::new(Stamp::ZERO, ImageSize { width: 2, height: 1 }, &rgb).unwrap();
        assert_eq!((image.height(), image.pixels()), (1, [[1, 2, 3], [4, 5, 6]].as_slice()));
        assert!(ColorImage::new(Stamp::ZERO, ImageSize { width: 2, height: 1 }, &rgb[..5]).is_err());
        assert!(ColorImage::new(Stamp::ZERO, ImageSize { width: 0, height: 2 }, &rgb).is_err());
    }
}
