//! A colour image as the camera delivers it: three bytes a pixel, sRGB.

use super::depth_image::WrongImageSize;
use crate::time::Stamp;

/// A checked view of colour pixels, row by row from the top left. Invariant: `width × height` pixels, both ≥ 1.
#[derive(Clone, Copy, Debug)]
pub struct ColorImage<'a> {
    stamp: Stamp,
    width: usize,
    pixels: &'a [[u8; 3]],
}

impl<'a> ColorImage<'a> {
    /// A view of `width × height` pixels of red, green, blue, taken at `stamp`.
    ///
    /// # Errors
    /// The slice has another length, or a side is zero: the frame was cut or belongs to another camera mode. Drop it.
    pub fn new(stamp: Stamp, (width, height): (usize, usize), rgb: &'a [u8]) -> Result<Self, WrongImageSize> {
        let (pixels, rest) = rgb.as_chunks::<3>();
        let is_whole = width > 0 && height > 0 && width.checked_mul(height) == Some(pixels.len());
        if is_whole && rest.is_empty() {
            Ok(Self { stamp, width, pixels })
        } else {
            Err(WrongImageSize { width, height, values: rgb.len() })
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
        self.pixels.len().checked_div(self.width).unwrap_or(0)
    }

    /// All pixels, row by row.
    #[must_use]
    pub const fn pixels(&self) -> &'a [[u8; 3]] {
        self.pixels
    }

    /// The rows, from the top.
    pub fn rows(&self) -> core::slice::ChunksExact<'a, [u8; 3]> {
        self.pixels.chunks_exact(self.width.max(1))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_cut_image_is_refused() {
        let rgb = [1, 2, 3, 4, 5, 6];
        let image = ColorImage::new(Stamp::ZERO, (2, 1), &rgb).unwrap();
        assert_eq!((image.height(), image.pixels()), (1, [[1, 2, 3], [4, 5, 6]].as_slice()));
        assert!(ColorImage::new(Stamp::ZERO, (2, 1), &rgb[..5]).is_err());
        assert!(ColorImage::new(Stamp::ZERO, (0, 2), &rgb).is_err());
    }
}
