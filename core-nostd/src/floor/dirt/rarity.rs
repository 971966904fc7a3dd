//! Our detector: pixels whose colour is rare on this floor, and far from what surrounds them.
//!
//! Light falls off over an image, so the colour is taken relative to the median of the wide surroundings. Tile gaps
//! and patterns differ too, but they recur all over the floor: a histogram of the relative colours, in units of their
//! spread, says how rare each is. Nothing is trained; the image itself is the reference. Works at half resolution,
//! where a pixel is the mean of four and its noise half.

use super::blocks::DirtFault;
use super::lab::{Lab, LabTables};
use super::order::{median_and_spread, quantiles};
use crate::capacities::FLOOR_IMAGE_COLUMNS_MAX;
use crate::sensing::ColorImage;

/// Pixels of the image along one pixel of the result.
pub const RARITY_BIN: usize = 2;
/// Columns at half resolution.
const COLUMNS_MAX: usize = FLOOR_IMAGE_COLUMNS_MAX / RARITY_BIN;
/// Pixels of the result along one cell of the surroundings: 16 of the image.
const CELL: usize = 8;
const CELL_COLUMNS_MAX: usize = COLUMNS_MAX / CELL + 1;
/// Rows of cells: images are at most as high as wide.
const CELLS_MAX: usize = CELL_COLUMNS_MAX * CELL_COLUMNS_MAX;
/// Cells to each side whose median is the surroundings, taken at every second one.
const REACH: i32 = 4;
const TAPS: usize = 25;
/// Levels of a relative colour along each axis: −7…7 spreads, and one that stays empty.
const LEVELS: usize = 16;
const LEVEL_MAX: f32 = 7.0;
const HISTOGRAM: usize = LEVELS * LEVELS * LEVELS;
/// Least spread, Lab units: half of what one just sees.
const SPREAD_MIN: f32 = 0.3;
/// What distance counts against rarity: as two natural logarithms.
const DISTANCE_WEIGHT: f32 = 2.0;
/// Standard deviations above the median that are dirt (algorithms F.1 step 7).
const DEVIATIONS: f32 = 6.0;
/// Fewest usable pixels of the result: 60 blocks of 16 × 16 (algorithms F.1 step 4).
const PIXELS_MIN: usize = 60 * CELL * CELL;

/// Working memory, one value for each pixel at half resolution in each slice.
pub struct RarityMemory<'a> {
    /// Colours, then relative colours.
    pub colours: &'a mut [Lab],
    /// Smoothed colours.
    pub smooth: &'a mut [Lab],
    /// The result: how rare and far each pixel is; NaN where it is no free floor.
    pub scores: &'a mut [f32],
}

/// The detector and its fixed tables.
#[derive(Clone, Debug)]
pub struct RarityDetector {
    tables: LabTables,
    means: [Lab; CELLS_MAX],
    around: [Lab; CELLS_MAX],
    histogram: [f32; HISTOGRAM],
    columns: usize,
    rows: usize,
    threshold: f32,
}

impl Default for RarityDetector {
    fn default() -> Self {
        Self {
            tables: LabTables::default(),
            means: [[f32::NAN; 3]; CELLS_MAX],
            around: [[f32::NAN; 3]; CELLS_MAX],
            histogram: [0.0; HISTOGRAM],
            columns: 0,
            rows: 0,
            threshold: f32::INFINITY,
        }
    }
}

impl RarityDetector {
    /// Columns of the result: half of the image's.
    #[must_use]
    pub const fn columns(&self) -> usize {
        self.columns
    }

    /// A score above this is dirt.
    #[must_use]
    pub const fn threshold(&self) -> f32 {
        self.threshold
    }

    /// Judges the pixels of an image. `usable` says of each pixel whether it is free floor.
    ///
    /// # Errors
    /// The image cannot be judged: its floor is unknown.
    pub fn detect(
        &mut self,
        image: &ColorImage<'_>,
        usable: &[bool],
        memory: &mut RarityMemory<'_>,
    ) -> Result<(), DirtFault> {
        self.threshold = f32::INFINITY;
        let pixels = self.measure(image, usable, memory)?;
        shrink(&self.tables, (image, usable), memory.colours);
        smooth(memory.colours.get(..pixels).unwrap_or(&[]), self.columns, memory.smooth);
        let found = memory.smooth.iter().take(pixels).filter(|[light, ..]| !light.is_nan()).count();
        if found < PIXELS_MIN {
            return Err(DirtFault::TooLittleFloor(found / (CELL * CELL), PIXELS_MIN / (CELL * CELL)));
        }
        self.average(memory.smooth);
        self.surround();
        self.relate(memory);
        let spreads = [0, 1, 2].map(|channel| spread(memory.colours, pixels, channel));
        let inverse = spreads.map(|spread| 1.0 / spread);
        self.count(memory.colours.get(..pixels).unwrap_or(&[]), inverse);
        self.score(memory, pixels, inverse);
        let scores = memory.scores.iter().take(pixels).step_by(3).copied();
        self.threshold =
            median_and_spread(scores).map_or(f32::INFINITY, |(median, spread)| median + DEVIATIONS * spread);
        Ok(())
    }

    /// Sizes; the number of pixels of the result.
    fn measure(
        &mut self,
        image: &ColorImage<'_>,
        usable: &[bool],
        memory: &RarityMemory<'_>,
    ) -> Result<usize, DirtFault> {
        let (width, height) = (image.width(), image.height());
        if width > FLOOR_IMAGE_COLUMNS_MAX || height > FLOOR_IMAGE_COLUMNS_MAX {
            return Err(DirtFault::TooWide(width.max(height)));
        }
        if usable.len() != image.pixels().len() {
            return Err(DirtFault::WrongMask(usable.len(), image.pixels().len()));
        }
        self.columns = width / RARITY_BIN;
        self.rows = height / RARITY_BIN;
        let pixels = self.columns.saturating_mul(self.rows);
        let room = memory.colours.len().min(memory.smooth.len()).min(memory.scores.len());
        if room < pixels {
            return Err(DirtFault::MemoryTooSmall(room, pixels));
        }
        Ok(pixels)
    }

    /// Mean colour of every cell; NaN where less than a quarter of it is free floor.
    fn average(&mut self, smooth: &[Lab]) {
        self.means = [[f32::NAN; 3]; CELLS_MAX];
        let stripe = self.columns.saturating_mul(CELL).max(1);
        let height = self.columns.saturating_mul(self.rows);
        let smooth = smooth.get(..height).unwrap_or(&[]);
        for (stripe, means) in smooth.chunks(stripe).zip(self.means.chunks_mut(CELL_COLUMNS_MAX)) {
            let mut sums = [[0.0_f32; 4]; CELL_COLUMNS_MAX];
            for row in stripe.chunks(self.columns.max(1)) {
                for (cell, sums) in row.chunks(CELL).zip(&mut sums) {
                    for [l, a, b] in cell.iter().filter(|[light, ..]| !light.is_nan()) {
                        let [sum_l, sum_a, sum_b, count] = sums;
                        *sum_l += l;
                        *sum_a += a;
                        *sum_b += b;
                        *count += 1.0;
                    }
                }
            }
            for (mean, [l, a, b, count]) in means.iter_mut().zip(sums) {
                if count >= (CELL * CELL / 4) as f32 {
                    *mean = [l / count, a / count, b / count];
                }
            }
        }
    }

    /// Median of the cells around every cell, mirrored at the edges.
    fn surround(&mut self) {
        let cells = [self.columns.div_ceil(CELL), self.rows.div_ceil(CELL)].map(|n| n as i32);
        let [wide, high] = cells;
        let means = &self.means;
        let at = |column: i32, row: i32| {
            let mirrored = |place: i32, count: i32| {
                let last = count.saturating_sub(1).max(0);
                let place = place.abs();
                let place = if place > last { last.saturating_mul(2).saturating_sub(place) } else { place };
                place.clamp(0, last) as usize
            };
            let index =
                mirrored(row, high).saturating_mul(CELL_COLUMNS_MAX).saturating_add(mirrored(column, wide));
            means.get(index).copied().unwrap_or([f32::NAN; 3])
        };
        for (row, line) in (0..high).zip(self.around.chunks_mut(CELL_COLUMNS_MAX)) {
            for (column, around) in (0..wide).zip(line) {
                let mut taps = [[f32::NAN; TAPS]; 3];
                let offsets = (-REACH..=REACH).step_by(2);
                let places = offsets.clone().flat_map(|dy| offsets.clone().map(move |dx| (dx, dy)));
                for (index, (dx, dy)) in places.enumerate() {
                    let mean = at(column.saturating_add(dx), row.saturating_add(dy));
                    for (taps, value) in taps.iter_mut().zip(mean) {
                        if let Some(slot) = taps.get_mut(index) {
                            *slot = value;
                        }
                    }
                }
                *around = taps.map(median);
            }
        }
    }

    /// Colours relative to their surroundings, interpolated between the centres of the cells.
    fn relate(&self, memory: &mut RarityMemory<'_>) {
        let columns = self.columns.max(1);
        let rows = memory.smooth.chunks(columns).zip(memory.colours.chunks_mut(columns)).take(self.rows);
        let last_row = self.rows.div_ceil(CELL).saturating_sub(1);
        let last_column = self.columns.div_ceil(CELL).saturating_sub(1);
        for (row, (smooth, relative)) in rows.enumerate() {
            let (upper, down) = place(row, last_row);
            let line =
                |row: usize| self.around.chunks(CELL_COLUMNS_MAX).nth(row.min(last_row)).unwrap_or(&[]);
            let mut between = [[0.0_f32; 3]; CELL_COLUMNS_MAX];
            let both = line(upper).iter().zip(line(upper.saturating_add(1)));
            for (slot, (a, b)) in between.iter_mut().zip(both) {
                *slot = mix(*a, *b, down);
            }
            for (column, (smooth, relative)) in smooth.iter().zip(relative).enumerate() {
                let (left, across) = place(column, last_column);
                let at = |cell: usize| between.get(cell.min(last_column)).copied().unwrap_or([f32::NAN; 3]);
                let [l, a, b] = mix(at(left), at(left.saturating_add(1)), across);
                let [own_l, own_a, own_b] = *smooth;
                *relative = [own_l - l, own_a - a, own_b - b];
            }
        }
    }

    /// Histogram of the relative colours, smoothed along each axis, as minus the logarithm of the frequency.
    fn count(&mut self, relative: &[Lab], inverse: [f32; 3]) {
        self.histogram = [0.0; HISTOGRAM];
        let mut total = 0.0_f32;
        for colour in relative {
            if let Some((cell, _)) = level(*colour, inverse)
                && let Some(slot) = self.histogram.get_mut(cell)
            {
                *slot += 1.0;
                total += 1.0;
            }
        }
        for stride in [1, LEVELS, LEVELS * LEVELS] {
            let before = self.histogram;
            let lower = core::iter::repeat_n(&0.0, stride).chain(&before);
            let upper = before.iter().skip(stride).chain(core::iter::repeat_n(&0.0, stride));
            for (slot, (below, above)) in self.histogram.iter_mut().zip(lower.zip(upper)) {
                *slot = 0.5 * *slot + 0.25 * (below + above);
            }
        }
        let total = total.max(1.0);
        for slot in &mut self.histogram {
            *slot = -libm::logf((*slot + 0.5) / total);
        }
    }

    /// Rarity and distance of every pixel, averaged over its neighbours.
    fn score(&self, memory: &mut RarityMemory<'_>, pixels: usize, inverse: [f32; 3]) {
        /// Steps of the table of distances: sixteenths of a spread, up to 32 spreads.
        const STEPS: usize = 512;
        let mut distances = [0.0_f32; STEPS];
        for (step, slot) in distances.iter_mut().enumerate() {
            *slot = DISTANCE_WEIGHT * libm::logf(1.0 + step as f32 / 16.0);
        }
        let raw = memory.smooth.iter_mut().zip(memory.colours.iter()).take(pixels);
        for (slot, colour) in raw {
            // The smoothed colours are no longer needed; their first channel takes the score.
            let [raw, ..] = slot;
            *raw = level(*colour, inverse).map_or(f32::NAN, |(cell, distance)| {
                let step = ((distance * 16.0) as usize).min(STEPS - 1);
                let rarity = self.histogram.get(cell).copied().unwrap_or(0.0);
                rarity + distances.get(step).copied().unwrap_or(0.0)
            });
        }
        blur(memory.smooth, self.columns, memory.scores);
    }
}

/// Mean of 2 × 2 pixels in Lab; NaN where one of them is no free floor.
fn shrink(tables: &LabTables, (image, usable): (&ColorImage<'_>, &[bool]), colours: &mut [Lab]) {
    let width = image.width().max(1);
    let columns = width / RARITY_BIN;
    let pairs = image.pixels().chunks_exact(width.saturating_mul(2));
    let masks = usable.chunks_exact(width.saturating_mul(2));
    for ((pixels, mask), row) in pairs.zip(masks).zip(colours.chunks_mut(columns.max(1))) {
        let ((upper, lower), (free_upper, free_lower)) = (pixels.split_at(width), mask.split_at(width));
        let quads = upper.as_chunks::<2>().0.iter().zip(lower.as_chunks::<2>().0);
        let frees = free_upper.as_chunks::<2>().0.iter().zip(free_lower.as_chunks::<2>().0);
        for (((upper, lower), (free_upper, free_lower)), slot) in quads.zip(frees).zip(row) {
            let ([[ar, ag, ab], [br, bg, bb]], [[cr, cg, cb], [dr, dg, db]]) = (*upper, *lower);
            // Four bytes and two for rounding fit 16 bits; a quarter of them fits a byte.
            let mean = |values: [u8; 4]| {
                (values.iter().map(|value| u16::from(*value)).sum::<u16>().wrapping_add(2) >> 2) as u8
            };
            let is_free = free_upper == &[true; 2] && free_lower == &[true; 2];
            *slot = if is_free {
                tables.lab([mean([ar, br, cr, dr]), mean([ag, bg, cg, dg]), mean([ab, bb, cb, db])])
            } else {
                [f32::NAN; 3]
            };
        }
    }
}

/// Mean of 3 × 3 pixels, edges repeated. A neighbour that is no floor makes the pixel none: edges of objects mix.
fn smooth(colours: &[Lab], columns: usize, smoothed: &mut [Lab]) {
    box_filter(colours, columns, |colour| *colour, smoothed, |slot, mean| *slot = mean);
}

/// The same of the first channel.
fn blur(raw: &[Lab], columns: usize, scores: &mut [f32]) {
    let first = |[value, ..]: &Lab| [*value];
    box_filter(raw, columns, first, scores, |slot, [mean]| *slot = mean);
}

fn box_filter<T, const N: usize>(
    values: &[Lab],
    columns: usize,
    read: impl Fn(&Lab) -> [f32; N],
    output: &mut [T],
    write: impl Fn(&mut T, [f32; N]),
) {
    let columns = columns.max(1);
    let rows = || values.chunks_exact(columns);
    let above = rows().take(1).chain(rows());
    let below = rows().skip(1).chain(rows().last());
    for (((above, own), below), output) in above.zip(rows()).zip(below).zip(output.chunks_mut(columns)) {
        let mut sums = [[0.0_f32; N]; COLUMNS_MAX];
        for (sum, ((a, b), c)) in sums.iter_mut().zip(above.iter().zip(own).zip(below)) {
            for ((sum, a), (b, c)) in sum.iter_mut().zip(read(a)).zip(read(b).into_iter().zip(read(c))) {
                *sum = a + b + c;
            }
        }
        let sums = sums.get(..columns.min(COLUMNS_MAX)).unwrap_or(&[]);
        let left = sums.iter().take(1).chain(sums);
        let right = sums.iter().skip(1).chain(sums.last());
        for (slot, ((left, own), right)) in output.iter_mut().zip(left.zip(sums).zip(right)) {
            let mut mean = [0.0; N];
            for ((mean, l), (o, r)) in mean.iter_mut().zip(left).zip(own.iter().zip(right)) {
                *mean = (l + o + r) / 9.0;
            }
            write(slot, mean);
        }
    }
}

/// Cell before a pixel and how far the pixel is towards the next, by the cells' centres.
fn place(pixel: usize, last: usize) -> (usize, f32) {
    let at = ((pixel as f32 + 0.5) / CELL as f32 - 0.5).clamp(0.0, last as f32);
    let cell = at as usize;
    (cell, at - cell as f32)
}

/// Between two colours; the known one where the other is not.
fn mix(a: Lab, b: Lab, part: f32) -> Lab {
    let ([al, aa, ab], [bl, ba, bb]) = (a, b);
    let blend = |a: f32, b: f32| {
        if a.is_nan() {
            b
        } else if b.is_nan() {
            a
        } else {
            a + part * (b - a)
        }
    };
    [blend(al, bl), blend(aa, ba), blend(ab, bb)]
}

/// Upper median of the known values, by insertion; NaN without one.
fn median(taps: [f32; TAPS]) -> f32 {
    let mut sorted: heapless::Vec<f32, TAPS> = heapless::Vec::new();
    for value in taps.into_iter().filter(|value| !value.is_nan()) {
        let place = sorted.iter().position(|other| *other > value).unwrap_or(sorted.len());
        // As many places as taps.
        let _ = sorted.insert(place, value);
    }
    sorted.get(sorted.len() / 2).copied().unwrap_or(f32::NAN)
}

/// Spread of one channel of the relative colours, over every third pixel.
fn spread(relative: &[Lab], pixels: usize, channel: usize) -> f32 {
    let values = relative
        .iter()
        .take(pixels)
        .step_by(3)
        .map(move |colour| colour.get(channel).copied().unwrap_or(f32::NAN).abs());
    quantiles(values, [0.5]).map_or(SPREAD_MIN, |[median]| 1.482_6 * median + SPREAD_MIN)
}

/// Cell of the histogram of a relative colour, and its largest distance in spreads; `None` for no floor.
#[inline]
fn level([l, a, b]: Lab, [il, ia, ib]: [f32; 3]) -> Option<(usize, f32)> {
    let (l, a, b) = (l * il, a * ia, b * ib);
    let distance = l.abs().max(a.abs()).max(b.abs());
    let bin = |value: f32| (value.clamp(-LEVEL_MAX, LEVEL_MAX) + LEVEL_MAX + 1.5) as usize;
    let cell = bin(l).wrapping_mul(LEVELS).wrapping_add(bin(a)).wrapping_mul(LEVELS).wrapping_add(bin(b));
    (!(l + a + b).is_nan()).then_some((cell, distance))
}
