//! An image with the time when it was taken, for cameras of all kinds.

use super::image_size::{ImageSize, ImageView, WrongImageSize};
use crate::time::Stamp;

/// A checked view of pixels, row by row from the top left. Invariant: `width × height` pixels, both ≥ 1.
#[derive(Clone, Copy, Debug)]
pub struct StampedImage<'a, P> {
    stamp: Stamp,
    view: ImageView<'a, P>,
}

impl<'a, P> StampedImage<'a, P> {
    /// A view of `pixels`, which `values` numbers make; an error tells these.
    pub(super) fn of(
        stamp: Stamp,
        size: ImageSize,
        (pixels, values): (&'a [P], usize),
    ) -> Result<Self, WrongImageSize> {
        let ImageSize { width, height } = size;
        let view = ImageView::new(size, pixels);
        view.map(|view| Self { stamp, view }).ok_or(WrongImageSize { width, height, values })
    }

    /// When the image was taken.
    #[must_use]
    pub const fn stamp(&self) -> Stamp {
        self.stamp
    }

    /// Columns, ≥ 1.
    #[must_use]
    pub const fn width(&self) -> usize {
        self.view.width()
    }

    /// Rows, ≥ 1.
    #[must_use]
    pub fn height(&self) -> usize {
        self.view.height()
    }

    /// All pixels, row by row.
    #[must_use]
    pub const fn pixels(&self) -> &'a [P] {
        self.view.pixels()
    }

    /// The rows, from the top.
    pub fn rows(&self) -> core::slice::ChunksExact<'a, P> {
        self.view.rows()
    }
}
