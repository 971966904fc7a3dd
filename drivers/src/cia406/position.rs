//! A position that starts over at the end of the encoder's range.

use floorguard_types::number::truncating_i32;

/// Follows the position through its wraps. The sum wraps at 32 bits, as core's odometry expects.
///
/// ```
/// use floorguard_drivers::cia406::PositionCounter;
///
/// // An encoder of 12 bits, turned back through its zero and on.
/// let mut counter = PositionCounter::new();
/// assert_eq!([10, 4_090, 20].map(|position| counter.update(position, 4_096)), [0, -16, 10]);
/// ```
#[derive(Clone, Copy, Debug, Default)]
pub struct PositionCounter {
    last: Option<u32>,
    total: i32,
}

impl PositionCounter {
    /// Nothing read yet.
    #[must_use]
    pub const fn new() -> Self {
        Self { last: None, total: 0 }
    }

    /// Takes in a position 0…`range` − 1; gives ticks since the first one. Right as long as less than half the range
    /// is rolled between two calls. A range of 0 stands for 2³².
    pub fn update(&mut self, position: u32, range: u32) -> i32 {
        let Some(last) = self.last.replace(position) else { return self.total };
        let step = i64::from(position) - i64::from(last);
        let range = if range == 0 { 1_i64 << 32 } else { i64::from(range) };
        let half = range / 2;
        // One wrap at most: both positions lie within the range, or the encoder lies and the odometry refuses it.
        let step = if step > half {
            step.saturating_sub(range)
        } else if step < half.saturating_neg() {
            step.saturating_add(range)
        } else {
            step
        };
        self.total = self.total.wrapping_add(truncating_i32(step));
        self.total
    }

    /// Forgets the last position: after a loss the wheel may have turned any way.
    pub const fn restart(&mut self) {
        self.last = None;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn wraps_both_ways() {
        let mut counter = PositionCounter::new();
        let range = 1 << 24;
        let seen = [range - 10, 5, range - 20, range - 30].map(|position| counter.update(position, range));
        assert_eq!(seen, [0, 15, -10, -20]);
        counter.restart();
        assert_eq!(counter.update(77, range), -20);
        assert_eq!(counter.update(78, range), -19);
    }

    #[test]
    fn a_range_of_nothing_is_the_whole_word() {
        let mut counter = PositionCounter::new();
        let seen = [u32::MAX - 9, 5, u32::MAX - 19].map(|position| counter.update(position, 0));
        assert_eq!(seen, [0, 15, -10]);
    }

    proptest! {
        /// Against the sum of the steps, for any range and any start.
        #[test]
        fn the_sum_of_all_steps(
            range in prop_oneof![Just(1_u32 << 24), 16_u32..=u32::MAX],
            start: u32,
            shares in proptest::collection::vec(-0.49_f64..0.49, 1..50),
        ) {
            let mut counter = PositionCounter::new();
            let mut position = i64::from(start % range);
            counter.update(start % range, range);
            let mut sum = 0_i64;
            for share in shares {
                let step = (share * f64::from(range)) as i64;
                (position, sum) = ((position + step).rem_euclid(i64::from(range)), sum + step);
                prop_assert_eq!(counter.update(position as u32, range), sum as i32);
            }
        }
    }

    #[test]
    fn the_whole_word_is_a_range_too() {
        let mut counter = PositionCounter::new();
        assert_eq!([u32::MAX, 1, u32::MAX].map(|position| counter.update(position, 0)), [0, 2, 0]);
    }
}
