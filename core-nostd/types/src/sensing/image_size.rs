//! The size of an image and what was delivered belong together, or the image is refused.

/// Pixels along the sides of an image.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct ImageSize {
    /// Columns.
    pub width: usize,
    /// Rows.
    pub height: usize,
}

/// An image whose pixels and size do not belong together: the frame was cut or belongs to another camera mode. Drop it.
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

/// A checked view of pixels, row by row from the top left. Invariant: `width × height` pixels, both ≥ 1.
#[derive(Clone, Copy, Debug)]
pub(super) struct ImageView<'a, T> {
    width: usize,
    pixels: &'a [T],
}

impl<'a, T> ImageView<'a, T> {
    /// `None` for another number of pixels, or a side of zero.
    pub(super) fn new(ImageSize { width, height }: ImageSize, pixels: &'a [T]) -> Option<Self> {
        let is_whole = width > 0 && height > 0 && width.checked_mul(height) == Some(pixels.len());
        is_whole.then_some(Self { width, pixels })
    }

    pub(super) const fn width(&self) -> usize {
        self.width
    }

    pub(super) fn height(&self) -> usize {
        self.pixels.len().checked_div(self.width).unwrap_or(0)
    }

    pub(super) const fn pixels(&self) -> &'a [T] {
        self.pixels
    }

    pub(super) fn rows(&self) -> core::slice::ChunksExact<'a, T> {
        self.pixels.chunks_exact(self.width.max(1))
    }
}
