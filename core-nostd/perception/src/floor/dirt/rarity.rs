//! How rare a value is on this floor: minus the logarithm of its frequency, and how far it lies from what is usual.
//!
//! Tile gaps, chips and grain differ from their surroundings too, but they recur all over the floor; dirt does not. The
//! values are counted in units of their own spread, so that nothing has to be known about the floor.

use floorguard_types::number::{count_f32, nearest_f32};

use super::order::quantiles;
use super::pixels::Pixel;
use crate::floor::root::{greater, lesser, logarithm, nearest};

/// Levels along each axis: −7…7 spreads, and one that stays empty.
const LEVELS: usize = 16;
const LEVEL_MAX: f32 = 7.0;
const CELLS: usize = LEVELS * LEVELS * LEVELS;
/// What distance counts against rarity: as two natural logarithms.
const DISTANCE_WEIGHT: f32 = 2.0;
/// Steps of the table of distances: sixteenths of a spread, up to 32 spreads.
const STEPS: usize = 512;
/// The spread is the median distance of each `SAMPLED`-th pixel, or of fewer, so that about `SAMPLES` of them count: within a
/// fiftieth of the median of all pixels.
const SAMPLED: usize = 5;
const SAMPLES: usize = 4_096;

/// The last of them, in spreads.
const DISTANCE_MAX: f32 = count_f32(STEPS - 1) / 16.0;

/// Frequencies of values of three channels.
#[derive(Clone, Debug)]
pub(super) struct Rarity {
    /// Minus the logarithm of the frequency of each cell.
    cells: [f32; CELLS],
    distances: [f32; STEPS],
    inverse_spread: [f32; 3],
}

impl Default for Rarity {
    fn default() -> Self {
        let mut distances = [0.0_f32; STEPS];
        for (step, slot) in distances.iter_mut().enumerate() {
            *slot = DISTANCE_WEIGHT * libm::logf(1.0 + nearest_f32(step) / 16.0);
        }
        Self { cells: [0.0; CELLS], distances, inverse_spread: [1.0; 3] }
    }
}

impl Rarity {
    /// Learns from values relative to their surroundings, of the pixels that count. `spread_min` is the least spread of
    /// a channel.
    pub(super) fn learn(&mut self, pixels: &[Pixel], spread_min: f32) {
        // An odd step does not keep to the same columns.
        let step = ((pixels.len() / SAMPLES) | 1).max(SAMPLED);
        for (channel, inverse) in self.inverse_spread.iter_mut().enumerate() {
            let distance = |pixel: &Pixel| {
                let [.., weight] = *pixel;
                let value = pixel.get(channel).copied().unwrap_or(f32::NAN).abs();
                if weight > 0.0 { value } else { f32::NAN }
            };
            let distances = pixels.iter().step_by(step).map(distance);
            let [median] = quantiles(distances, [0.5]).unwrap_or([0.0]);
            *inverse = 1.0 / (1.482_6 * median + spread_min);
        }
        self.cells = [0.0; CELLS];
        let mut total = 0.0_f32;
        for [x, y, z, weight] in pixels {
            if let Some((cell, _)) = self.cell([*x, *y, *z]).filter(|_| *weight > 0.0)
                && let Some(slot) = self.cells.get_mut(cell)
            {
                *slot += 1.0;
                total += 1.0;
            }
        }
        self.smooth();
        let total = total.max(1.0);
        for slot in &mut self.cells {
            *slot = -logarithm((*slot + 0.5) / total);
        }
    }

    /// A quarter of each cell to each neighbour along every axis. The empty level keeps rows from running into another.
    fn smooth(&mut self) {
        for stride in [1, LEVELS, LEVELS * LEVELS] {
            let before = self.cells;
            let lower = core::iter::repeat_n(&0.0, stride).chain(&before);
            let upper = before.iter().skip(stride).chain(core::iter::repeat_n(&0.0, stride));
            for (slot, (below, above)) in self.cells.iter_mut().zip(lower.zip(upper)) {
                *slot = 0.5 * *slot + 0.25 * (below + above);
            }
        }
    }

    /// How rare a value is, natural logarithms; NaN for NaN.
    #[inline]
    pub(super) fn of(&self, value: [f32; 3]) -> f32 {
        let Some((cell, distance)) = self.cell(value) else { return f32::NAN };
        let step = nearest(greater(16.0 * lesser(distance, DISTANCE_MAX) - 0.5, 0.0));
        let rarity = self.cells.get(cell).copied().unwrap_or(0.0);
        rarity + self.distances.get(step).copied().unwrap_or(0.0)
    }

    /// Cell of a value and its largest distance in spreads; `None` for NaN.
    #[inline]
    fn cell(&self, [x, y, z]: [f32; 3]) -> Option<(usize, f32)> {
        let [ix, iy, iz] = self.inverse_spread;
        let (x, y, z) = (x * ix, y * iy, z * iz);
        let distance = greater(greater(x.abs(), y.abs()), z.abs());
        let bin = |value: f32| nearest(greater(lesser(value, LEVEL_MAX), -LEVEL_MAX) + LEVEL_MAX + 1.0);
        let cell = bin(x).wrapping_mul(LEVELS).wrapping_add(bin(y)).wrapping_mul(LEVELS).wrapping_add(bin(z));
        (!(x + y + z).is_nan()).then_some((cell, distance))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// What recurs is not rare, however different it is; the same value seen once is.
    #[test]
    fn what_recurs_is_common() {
        let value = |index: usize| if index.is_multiple_of(20) { 6.0 } else { (index % 3) as f32 - 1.0 };
        let mut pixels: std::vec::Vec<Pixel> =
            (0..4_000).map(|index| [value(index), 0.0, 0.0, 1.0]).collect();
        pixels[7] = [0.0, 6.0, 0.0, 1.0];
        pixels[8] = [f32::NAN, 0.0, 0.0, 1.0];
        pixels[9] = [0.0, 0.0, 6.0, 0.0];
        let mut rarity = Rarity::default();
        rarity.learn(&pixels, 0.3);
        let (usual, gap, dirt) =
            (rarity.of([0.0; 3]), rarity.of([6.0, 0.0, 0.0]), rarity.of([0.0, 6.0, 0.0]));
        assert!(usual < gap && gap + 2.0 < dirt, "{usual} {gap} {dirt}");
        assert!(rarity.of([f32::NAN, 0.0, 0.0]).is_nan());
        assert!(rarity.of([f32::INFINITY, 0.0, 0.0]).is_finite());
    }
}
