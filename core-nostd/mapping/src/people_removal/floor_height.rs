//! How high the floor is: the lowest height below the sensor that many returns share.
//!
//! Not the height that most share: in a narrow corridor the lower rings end on the walls, all at nearly one height.

use floorguard_types::number::{nearest_f32, saturating_usize};

/// Counts heights in bins of 2 cm.
///
/// ```
/// use floorguard_mapping::people_removal::FloorHeight;
///
/// let mut heights = FloorHeight::below(0.8);
/// (0..100).for_each(|_| heights.enter(0.011));
/// (0..60).for_each(|step| heights.enter(0.01 * step as f32));
/// assert!((heights.floor_m().unwrap() - 0.01).abs() < 0.011);
/// assert_eq!(FloorHeight::below(0.8).floor_m(), None);
/// // Rings on the walls of a corridor are more, and higher.
/// (0..300).for_each(|_| heights.enter(0.48));
/// assert!((heights.floor_m().unwrap() - 0.01).abs() < 0.011);
/// ```
#[derive(Clone, Debug)]
pub struct FloorHeight {
    top_m: f32,
    bins: [u32; BINS],
    sums_m: [f32; BINS],
}

/// Height of a bin.
const BIN_M: f32 = 0.02;
/// Down to 3 m below the top.
const BINS: usize = 150;
/// The floor lies at least this far below the sensor, metres.
const CLEARANCE_M: f32 = 0.25;
/// With fewer returns no floor is claimed.
const RETURNS_MIN: u32 = 50;
/// The floor has at least one return for so many of the fullest height.
const SHARE: u32 = 5;
/// The fullest bins of the floor lie at most so many above its first ones: 8 cm of noise.
const RISE_BINS: usize = 4;

impl FloorHeight {
    /// Below a sensor at this height, in the map.
    #[must_use]
    pub const fn below(sensor_m: f32) -> Self {
        Self { top_m: sensor_m - CLEARANCE_M, bins: [0; BINS], sums_m: [0.0; BINS] }
    }

    /// Height of a return, in the map.
    #[inline]
    pub fn enter(&mut self, height_m: f32) {
        let below_m = self.top_m - height_m;
        // Also false for a NaN.
        if below_m >= 0.0 {
            let bin = saturating_usize(below_m / BIN_M);
            if let (Some(count), Some(sum_m)) = (self.bins.get_mut(bin), self.sums_m.get_mut(bin)) {
                *count = count.saturating_add(1);
                *sum_m += height_m;
            }
        }
    }

    /// Mean height of the fullest pair of bins of the lowest level; `None` with too few returns.
    #[must_use]
    pub fn floor_m(&self) -> Option<f32> {
        let fullest = self.bins.windows(2).map(|pair| pair.iter().sum::<u32>()).max().unwrap_or(0);
        let enough = RETURNS_MIN.max(fullest / SHARE);
        let pairs = || self.bins.windows(2).zip(self.sums_m.windows(2)).rev();
        let lowest = pairs().position(|(counts, _)| counts.iter().sum::<u32>() >= enough)?;
        let mut best = (0_u32, 0.0_f32);
        for (counts, sums_m) in pairs().skip(lowest).take(RISE_BINS) {
            let count: u32 = counts.iter().sum();
            if count > best.0 {
                best = (count, sums_m.iter().sum());
            }
        }
        let (count, sum_m) = best;
        (count > 0).then(|| sum_m / nearest_f32(count))
    }
}
