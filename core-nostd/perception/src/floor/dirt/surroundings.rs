//! What surrounds a place on the floor: the median of the cells around it, which light changes slowly and dirt hardly.

use super::pixels::{HALF_COLUMNS_MAX, Pixel};
use floorguard_types::number::{
    exact_usize, nearest_f32, saturating_usize, truncating_i32, truncating_usize,
};

/// Pixels of quarter size along a cell: 32 of the image.
pub(super) const CELL: usize = 8;
pub(super) const CELL_COLUMNS_MAX: usize = HALF_COLUMNS_MAX / 2 / CELL + 1;
/// Images are at most as high as wide.
const CELLS_MAX: usize = CELL_COLUMNS_MAX * CELL_COLUMNS_MAX;
/// Cells to each side whose median is the surroundings.
const REACH: i32 = 2;
const TAPS: usize = 25;

/// Medians around every cell of an image of quarter size.
#[derive(Clone, Debug)]
pub(super) struct Surroundings {
    means: [[f32; 3]; CELLS_MAX],
    around: [[f32; 3]; CELLS_MAX],
    columns: usize,
    rows: usize,
}

impl Default for Surroundings {
    fn default() -> Self {
        Self { means: [[f32::NAN; 3]; CELLS_MAX], around: [[f32::NAN; 3]; CELLS_MAX], columns: 0, rows: 0 }
    }
}

/// One row of surroundings, interpolated downwards; across it is interpolated for every pixel.
pub(super) struct Line {
    /// At every cell's centre, and the rise to the next one.
    values: [[[f32; 3]; 2]; CELL_COLUMNS_MAX],
    cell: usize,
}

impl Surroundings {
    /// Learns the surroundings from the first channels of an image of quarter size; of the others it is 0.
    pub(super) fn learn(&mut self, quarter: &[Pixel], (columns, rows): (usize, usize), channels: usize) {
        self.columns = columns.div_ceil(CELL).min(CELL_COLUMNS_MAX);
        self.rows = rows.div_ceil(CELL).min(CELL_COLUMNS_MAX);
        self.average(quarter, columns.max(1));
        self.take_medians(channels);
    }

    /// Mean of every cell; NaN where less than a quarter of it is free floor.
    fn average(&mut self, quarter: &[Pixel], columns: usize) {
        self.means = [[f32::NAN; 3]; CELLS_MAX];
        let stripes = quarter.chunks(columns.saturating_mul(CELL));
        for (stripe, means) in stripes.zip(self.means.chunks_mut(CELL_COLUMNS_MAX)) {
            let mut sums = [[0.0_f32; 4]; CELL_COLUMNS_MAX];
            for row in stripe.chunks(columns) {
                for (cell, sum) in row.chunks(CELL).zip(&mut sums) {
                    for [x, y, z, weight] in cell {
                        let [sx, sy, sz, total] = sum;
                        *sx += x * weight;
                        *sy += y * weight;
                        *sz += z * weight;
                        *total += weight;
                    }
                }
            }
            for (mean, [x, y, z, weight]) in means.iter_mut().zip(sums) {
                if weight >= nearest_f32(CELL * CELL / 4) {
                    *mean = [x / weight, y / weight, z / weight];
                }
            }
        }
    }

    /// Median of the cells around every cell, mirrored at the edges.
    fn take_medians(&mut self, channels: usize) {
        let (wide, high) = (truncating_i32(self.columns), truncating_i32(self.rows));
        let means = &self.means;
        let at = |column: i32, row: i32| {
            let mirrored = |place: i32, count: i32| {
                let last = count.saturating_sub(1).max(0);
                let place = place.abs();
                let place = if place > last { last.saturating_mul(2).saturating_sub(place) } else { place };
                truncating_usize(place.clamp(0, last))
            };
            let index =
                mirrored(row, high).saturating_mul(CELL_COLUMNS_MAX).saturating_add(mirrored(column, wide));
            means.get(index).copied().unwrap_or([f32::NAN; 3])
        };
        for (row, line) in self.around.chunks_mut(CELL_COLUMNS_MAX).take(self.rows).enumerate() {
            for (column, around) in line.iter_mut().take(self.columns).enumerate() {
                let mut taps = [[f32::NAN; TAPS]; 3];
                let places = (-REACH..=REACH).flat_map(|dy| (-REACH..=REACH).map(move |dx| (dx, dy)));
                for (index, (dx, dy)) in places.enumerate() {
                    let mean =
                        at(truncating_i32(column).saturating_add(dx), truncating_i32(row).saturating_add(dy));
                    for (taps, value) in taps.iter_mut().zip(mean) {
                        if let Some(slot) = taps.get_mut(index) {
                            *slot = value;
                        }
                    }
                }
                *around = [0.0; 3];
                for (around, taps) in around.iter_mut().zip(&taps).take(channels) {
                    *around = median(taps);
                }
            }
        }
    }

    /// The surroundings along a row of pixels, of which `pixels_a_cell` make a cell.
    pub(super) fn line(&self, row: usize, pixels_a_cell: usize) -> Line {
        let last_row = self.rows.saturating_sub(1);
        let (upper, down) = place(row, nearest_f32(pixels_a_cell.max(1)), last_row);
        let line = |row: usize| self.around.chunks(CELL_COLUMNS_MAX).nth(row.min(last_row)).unwrap_or(&[]);
        let mut values = [[[f32::NAN; 3]; 2]; CELL_COLUMNS_MAX];
        for ([slot, _], (a, b)) in
            values.iter_mut().zip(line(upper).iter().zip(line(upper.saturating_add(1))))
        {
            *slot = mix(*a, *b, down);
        }
        let last = self.columns.saturating_sub(1);
        let own = values;
        let unknown = [[[f32::NAN; 3]; 2]; CELL_COLUMNS_MAX];
        let next = own.iter().skip(1).take(last).chain(&unknown);
        for ([value, rise], ([own, _], [next, _])) in values.iter_mut().zip(own.iter().zip(next)) {
            // Where only one of two neighbours is known it stands for both, so that no pixel has to ask.
            let (left, right) = (mix(*own, *next, 0.0), mix(*own, *next, 1.0));
            *value = left;
            for (rise, (left, right)) in rise.iter_mut().zip(left.iter().zip(right)) {
                *rise = right - left;
            }
        }
        Line { values, cell: pixels_a_cell.max(1) }
    }
}

impl Line {
    /// Takes what surrounds them from the pixels of the row; NaN where nothing is known.
    pub(super) fn subtract(&self, pixels: &mut [Pixel]) {
        // Before the first cell's centre its value counts, from there on it rises to the next one's.
        let (first, others) = pixels.split_at_mut((self.cell / 2).min(pixels.len()));
        let [[start, _], ..] = self.values;
        first.iter_mut().for_each(|pixel| take(pixel, start));
        let step = 1.0 / nearest_f32(self.cell);
        for (pixels, [value, rise]) in others.chunks_mut(self.cell.max(1)).zip(&self.values) {
            let mut part = 0.5 * step;
            let ([x, y, z], [rx, ry, rz]) = (*value, *rise);
            for pixel in pixels {
                take(pixel, [x + part * rx, y + part * ry, z + part * rz]);
                part += step;
            }
        }
    }
}

#[inline]
fn take([x, y, z, _]: &mut Pixel, [ax, ay, az]: [f32; 3]) {
    (*x, *y, *z) = (*x - ax, *y - ay, *z - az);
}

/// Cell before a pixel and how far the pixel is towards the next, by the cells' centres.
#[inline]
fn place(pixel: usize, cell: f32, last: usize) -> (usize, f32) {
    let at = ((nearest_f32(pixel) + 0.5) / cell - 0.5).clamp(0.0, nearest_f32(last));
    let before = saturating_usize(at);
    (before, at - nearest_f32(before))
}

/// Between two values; the known one where the other is not.
#[inline]
fn mix([ax, ay, az]: [f32; 3], [bx, by, bz]: [f32; 3], part: f32) -> [f32; 3] {
    // All three are known or none is.
    if ax.is_nan() {
        [bx, by, bz]
    } else if bx.is_nan() {
        [ax, ay, az]
    } else {
        [ax + part * (bx - ax), ay + part * (by - ay), az + part * (bz - az)]
    }
}

/// Upper median of the known values: the one with as many below it as above. NaN without one.
fn median(taps: &[f32; TAPS]) -> f32 {
    let known = taps.iter().filter(|value| !value.is_nan()).count();
    let wanted = known / 2;
    for value in taps {
        // Comparisons with NaN are false, so unknown values count nowhere; counting is faster than sorting 25 values.
        let below: u32 = taps.iter().map(|other| u32::from(other < value)).sum();
        let equal: u32 = taps.iter().map(|other| u32::from(other == value)).sum();
        let rank = exact_usize(below);
        if rank <= wanted && wanted < rank.saturating_add(exact_usize(equal)) {
            return *value;
        }
    }
    f32::NAN
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn medians_are_those_of_sorting() {
        let mut random = floorguard_types::random::Pcg32::new(6, 6);
        for known in [1, 2, 7, 24, 25] {
            let mut taps = [f32::NAN; TAPS];
            for slot in taps.iter_mut().take(known) {
                *slot = random.below(9) as f32;
            }
            let mut sorted = taps[..known].to_vec();
            sorted.sort_by(f32::total_cmp);
            assert_eq!(median(&taps), sorted[known / 2], "{taps:?}");
        }
        assert!(median(&[f32::NAN; TAPS]).is_nan());
    }

    /// A spot does not change what surrounds it, and a slow ramp is followed.
    #[test]
    fn follows_light_and_not_dirt() {
        // 40 columns are the capacity of the smallest profile.
        let (columns, rows) = (40, 32);
        assert!(columns <= HALF_COLUMNS_MAX / 2);
        let ramp = |column: usize| 40.0 + 0.2 * column as f32;
        let mut image: std::vec::Vec<Pixel> =
            (0..columns * rows).map(|index| [ramp(index % columns), 1.0, 2.0, 1.0]).collect();
        for (index, pixel) in image.iter_mut().enumerate() {
            if (index % columns).abs_diff(20) < 5 && (index / columns).abs_diff(16) < 5 {
                pixel[0] = 90.0;
            }
        }
        let mut around = Surroundings::default();
        around.learn(&image, (columns, rows), 3);
        for column in [10, 20, 30] {
            let mut row = [[0.0_f32; 4]; 40];
            around.line(16, CELL).subtract(&mut row);
            let [l, a, b, _] = row[column];
            assert!((l + ramp(column)).abs() < 2.5 && a == -1.0 && b == -2.0, "{column}: {l}");
        }
    }
}
