//! Texture of an image in blocks: mean and standard deviation of the gradient, for each Lab channel.
//!
//! Three rows of Lab are open at once, whatever the height of the image. A block counts only where every pixel is
//! free floor; saturated light says nothing. Source: book, Floor and dirt: Published dirt detector.

use heapless::Vec;

use super::lab::LabTables;
use super::mixture::Point;
use crate::floor::root::square_root;
use floorguard_types::capacities::{FLOOR_BLOCKS_MAX, FLOOR_IMAGE_COLUMNS_MAX};
use floorguard_types::number::{count_f32, truncating_u16};
use floorguard_types::sensing::ColorImage;

/// Pixels along a block (book, Floor and dirt: Published dirt detector).
pub const BLOCK: usize = 16;
/// Saturated pixels of a block that make it unknown: 5 % (book, Floor and dirt: Published dirt detector).
const SATURATED_MAX: u16 = 12;
/// A channel at this value is saturated.
const SATURATED: u8 = 255;

/// Why an image cannot be judged; all of its floor is unknown, not clean.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum DirtFault {
    /// The image has this many columns, more than the capacity.
    TooWide(usize),
    /// The image has this many blocks, more than the capacity.
    TooManyBlocks(usize),
    /// The mask is none of this image.
    WrongMask {
        /// Values of the mask.
        values: usize,
        /// Pixels of the image.
        pixels: usize,
    },
    /// The working memory is too small.
    MemoryTooSmall {
        /// Pixels for which there is memory.
        given: usize,
        /// Pixels of the image.
        needed: usize,
    },
    /// Too little free floor.
    TooLittleFloor {
        /// Blocks of free floor.
        found: usize,
        /// Blocks that a judgement needs.
        needed: usize,
    },
    /// So many percent of the floor are black or overexposed: a covered or blinded camera, which says nothing of dirt.
    Unlit(usize),
}

impl core::fmt::Display for DirtFault {
    fn fmt(&self, formatter: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        match self {
            Self::TooWide(width) => write!(
                formatter,
                "the image has {width} columns, but the capacity is {FLOOR_IMAGE_COLUMNS_MAX}"
            ),
            Self::TooManyBlocks(blocks) => {
                write!(formatter, "the image has {blocks} blocks, but the capacity is {FLOOR_BLOCKS_MAX}")
            }
            Self::WrongMask { values, pixels } => {
                write!(formatter, "the mask has {values} values for {pixels} pixels")
            }
            Self::MemoryTooSmall { given, needed } => {
                write!(formatter, "working memory for {given} pixels, but {needed} are needed")
            }
            Self::TooLittleFloor { found, needed } => {
                write!(formatter, "only {found} blocks of free floor, {needed} are needed")
            }
            Self::Unlit(percent) => {
                write!(
                    formatter,
                    "{percent} % of the floor is black or overexposed: a covered or blinded camera"
                )
            }
        }
    }
}

impl core::error::Error for DirtFault {}

/// One block.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Block {
    /// Mean and standard deviation of the gradient of L, a and b, in Lab units a pixel.
    pub features: [Point; 3],
    /// True where every pixel is free floor and almost none is saturated.
    pub is_usable: bool,
}

type Row = [f32; FLOOR_IMAGE_COLUMNS_MAX];
/// L, a and b of a row.
type LabRow = [Row; 3];
const COLUMNS_MAX: usize = FLOOR_IMAGE_COLUMNS_MAX / BLOCK;

/// Sums of one block while its rows pass.
#[derive(Clone, Copy, Debug, Default)]
struct Growing {
    sums: [[f32; 2]; 3],
    unusable: u16,
    saturated: u16,
}

/// The blocks of an image, and the rows that are open.
#[derive(Clone, Debug)]
pub struct BlockGrid {
    tables: LabTables,
    open: [LabRow; 3],
    growing: [Growing; COLUMNS_MAX],
    columns: usize,
    blocks: Vec<Block, FLOOR_BLOCKS_MAX>,
}

impl Default for BlockGrid {
    fn default() -> Self {
        Self {
            tables: LabTables::default(),
            open: [[[0.0; FLOOR_IMAGE_COLUMNS_MAX]; 3]; 3],
            growing: [Growing::default(); COLUMNS_MAX],
            columns: 0,
            blocks: Vec::new(),
        }
    }
}

impl BlockGrid {
    /// Blocks in a row of blocks.
    #[must_use]
    pub const fn columns(&self) -> usize {
        self.columns
    }

    /// The blocks, row by row. What does not fill a block at the right and lower edge is not covered.
    #[must_use]
    pub fn blocks(&self) -> &[Block] {
        &self.blocks
    }

    /// Measures all blocks. `usable` says of each pixel whether it is free floor.
    ///
    /// # Errors
    /// Image or mask do not fit.
    pub fn measure(&mut self, image: &ColorImage<'_>, usable: &[bool]) -> Result<(), DirtFault> {
        let (width, height) = (image.width(), image.height());
        self.columns = width / BLOCK;
        let count = self.columns.saturating_mul(height / BLOCK);
        self.blocks.clear();
        if width > FLOOR_IMAGE_COLUMNS_MAX {
            return Err(DirtFault::TooWide(width));
        }
        if count > FLOOR_BLOCKS_MAX {
            return Err(DirtFault::TooManyBlocks(count));
        }
        if usable.len() != image.pixels().len() {
            return Err(DirtFault::WrongMask { values: usable.len(), pixels: image.pixels().len() });
        }
        let mut masks = usable.chunks_exact(width.max(1)).zip(image.rows());
        for (row, pixels) in image.rows().map(Some).chain(core::iter::once(None)).enumerate() {
            let Some(pixels) = pixels else {
                // Below the last row there is none: the gradient there is one-sided.
                self.open.rotate_left(1);
                let [_, middle, lower] = &mut self.open;
                *lower = *middle;
                self.close(height.saturating_sub(1), true, masks.next());
                break;
            };
            self.open.rotate_left(1);
            let [_, middle, lower] = &mut self.open;
            to_lab(&self.tables, pixels, lower);
            if row == 0 {
                *middle = *lower;
                continue;
            }
            self.close(row.saturating_sub(1), row == 1, masks.next());
        }
        Ok(())
    }

    /// The middle row, now that its lower neighbour is known; `is_edge` where it stands in for a missing neighbour.
    fn close(&mut self, row: usize, is_edge: bool, source: Option<(&[bool], &[[u8; 3]])>) {
        let Some((usable, pixels)) = source else { return };
        let scale = if is_edge { 1.0 } else { 0.5 };
        let width = pixels.len();
        let [upper, middle, lower] = &self.open;
        for (channel, ((a, own), b)) in upper.iter().zip(middle).zip(lower).enumerate() {
            let mut gradient: Row = [0.0; FLOOR_IMAGE_COLUMNS_MAX];
            magnitudes((a, own, b), width, scale, &mut gradient);
            let used = self.columns.saturating_mul(BLOCK);
            for (growing, values) in
                self.growing.iter_mut().zip(gradient.as_chunks::<BLOCK>().0.iter().take(used / BLOCK))
            {
                let (mut sum, mut squares) = (0.0, 0.0);
                for value in values {
                    sum += value;
                    squares += value * value;
                }
                if let Some([total, total_squares]) = growing.sums.get_mut(channel) {
                    *total += sum;
                    *total_squares += squares;
                }
            }
        }
        for ((growing, usable), pixels) in
            self.growing.iter_mut().zip(usable.as_chunks::<BLOCK>().0).zip(pixels.as_chunks::<BLOCK>().0)
        {
            let blocked = usable.iter().filter(|is_usable| !**is_usable).count();
            let bright = pixels.iter().filter(|pixel| pixel.contains(&SATURATED)).count();
            // At most 16 each.
            growing.unusable = growing.unusable.saturating_add(truncating_u16(blocked));
            growing.saturated = growing.saturated.saturating_add(truncating_u16(bright));
        }
        if row % BLOCK == BLOCK - 1 {
            for growing in self.growing.iter().take(self.columns) {
                // The count was checked against the capacity before the first row.
                let _ = self.blocks.push(growing.finished());
            }
            self.growing = [Growing::default(); COLUMNS_MAX];
        }
    }
}

impl Growing {
    fn finished(&self) -> Block {
        const PIXELS: f32 = count_f32(BLOCK * BLOCK);
        let features = self.sums.map(|[sum, squares]| {
            let mean = sum / PIXELS;
            [mean, square_root((squares / PIXELS - mean * mean).max(0.0))]
        });
        Block { features, is_usable: self.unusable == 0 && self.saturated <= SATURATED_MAX }
    }
}

fn to_lab(tables: &LabTables, pixels: &[[u8; 3]], row: &mut LabRow) {
    let [light, green_red, blue_yellow] = row;
    for (((pixel, l), a), b) in pixels.iter().zip(light).zip(green_red).zip(blue_yellow) {
        [*l, *a, *b] = tables.lab(*pixel);
    }
}

/// Length of the gradient: central differences, one-sided at the edges of the image.
fn magnitudes((above, own, below): (&Row, &Row, &Row), width: usize, scale: f32, gradient: &mut Row) {
    let inner = own.windows(3).zip(above.iter().zip(below).skip(1)).zip(gradient.iter_mut().skip(1));
    for ((neighbours, (up, down)), slot) in inner.take(width.saturating_sub(2)) {
        let [left, _, right] = neighbours else { continue };
        let (x, y) = (0.5 * (right - left), scale * (down - up));
        *slot = square_root(x * x + y * y);
    }
    let at = |row: &Row, column: usize| row.get(column).copied().unwrap_or(0.0);
    let last = width.saturating_sub(1);
    for (column, left, right) in [(0, 0, 1.min(last)), (last, last.saturating_sub(1), last)] {
        let (x, y) = (at(own, right) - at(own, left), scale * (at(below, column) - at(above, column)));
        if let Some(slot) = gradient.get_mut(column) {
            *slot = square_root(x * x + y * y);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use floorguard_types::sensing::ImageSize;
    use floorguard_types::time::Stamp;

    /// A ramp in lightness across, and a step down the middle of the second block: both by direct computation.
    #[test]
    fn features_are_moments_of_the_gradient() {
        const SIZE: ImageSize = ImageSize { width: 48, height: 32 };
        let mut random = floorguard_types::random::Pcg32::new(4, 4);
        let rgb: std::vec::Vec<u8> =
            (0..SIZE.width * SIZE.height * 3).map(|_| (random.below(200)) as u8).collect();
        let image = ColorImage::new(Stamp::ZERO, SIZE, &rgb).unwrap();
        let mut usable = std::vec![true; SIZE.width * SIZE.height];
        usable[20] = false;
        let mut grid = BlockGrid::default();
        grid.measure(&image, &usable).unwrap();
        assert_eq!((grid.columns(), grid.blocks().len()), (3, 6));
        let usable: std::vec::Vec<bool> = grid.blocks().iter().map(|block| block.is_usable).collect();
        assert_eq!(usable, [true, false, true, true, true, true]);
        let tables = LabTables::default();
        let at = |x: usize, y: usize, channel: usize| tables.lab(image.pixels()[y * SIZE.width + x])[channel];
        for (index, block) in grid.blocks().iter().enumerate() {
            let (left, top) = (index % 3 * BLOCK, index / 3 * BLOCK);
            for channel in 0..3 {
                let (mut sum, mut squares) = (0.0_f64, 0.0_f64);
                for y in top..top + BLOCK {
                    for x in left..left + BLOCK {
                        let (x0, x1) = (x.saturating_sub(1), (x + 1).min(SIZE.width - 1));
                        let (y0, y1) = (y.saturating_sub(1), (y + 1).min(SIZE.height - 1));
                        let gx = (at(x1, y, channel) - at(x0, y, channel)) / (x1 - x0) as f32;
                        let gy = (at(x, y1, channel) - at(x, y0, channel)) / (y1 - y0) as f32;
                        let squared = f64::from(gx * gx + gy * gy);
                        sum += squared.sqrt();
                        squares += squared;
                    }
                }
                let mean = sum / 256.0;
                let deviation = (squares / 256.0 - mean * mean).sqrt();
                let [found_mean, found_deviation] = block.features[channel];
                assert!((f64::from(found_mean) - mean).abs() < 1e-3, "{index} {channel}");
                assert!((f64::from(found_deviation) - deviation).abs() < 1e-2, "{index} {channel}");
            }
        }
    }

    #[test]
    fn wrong_sizes_are_refused() {
        let rgb = [0; 32 * 16 * 3];
        let image = ColorImage::new(Stamp::ZERO, ImageSize { width: 32, height: 16 }, &rgb).unwrap();
        let mut grid = BlockGrid::default();
        assert_eq!(grid.measure(&image, &[true; 5]), Err(DirtFault::WrongMask { values: 5, pixels: 512 }));
        let wide = std::vec![0; 4_000 * 3];
        let image = ColorImage::new(Stamp::ZERO, ImageSize { width: 4_000, height: 1 }, &wide).unwrap();
        assert_eq!(grid.measure(&image, &[true; 4_000]), Err(DirtFault::TooWide(4_000)));
    }
}
