//! Which of a few values stands where, without sorting them.

use core::cmp::Ordering;

/// The value with as many before it as `rank` says, from 0, in a total order; the last one where there are not so many, `None`
/// where there are none. Counted for each value: the library's sort recurses and may panic.
pub(super) fn of_rank<T: Copy>(values: &[T], rank: usize, order: impl Fn(&T, &T) -> Ordering) -> Option<T> {
    let before = |value: &T| values.iter().filter(|other| order(other, value).is_lt()).count();
    values.iter().copied().filter(|value| before(value) <= rank).max_by(|a, b| order(a, b))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Bit for bit: minus zero comes before zero.
    #[test]
    fn ranks_are_those_of_sorting() {
        let mut random = floorguard_types::random::Pcg32::new(4, 4);
        for count in 1..=9_usize {
            for _ in 0..50 {
                let below = |random: &mut floorguard_types::random::Pcg32| random.below(5) as f32 - 2.0;
                let values: std::vec::Vec<f32> =
                    (0..count).map(|_| below(&mut random) * 0.0_f32.max(below(&mut random))).collect();
                let mut sorted = values.clone();
                sorted.sort_by(f32::total_cmp);
                for (rank, expected) in sorted.iter().enumerate() {
                    let found = of_rank(&values, rank, f32::total_cmp).map(f32::to_bits);
                    assert_eq!(found, Some(expected.to_bits()), "{rank} of {values:?}");
                }
            }
        }
        assert_eq!(of_rank(&[3, 1, 2], 9, Ord::cmp), Some(3));
        assert_eq!(of_rank(&[], 0, u8::cmp), None);
    }
}
