//! Quantiles in constant memory: a histogram between the smallest and the largest value.
//!
//! One bin of 1,024 is the error, far below what any threshold here means. Source: book, Conventions: Quantiles.

use floorguard_types::number::{nearest_f32, saturating_u32, saturating_usize};

const BINS: usize = 1_024;

/// The value below which the given parts of the values lie, for ascending parts within 0..=1. `None` without a finite
/// value.
pub(super) fn quantiles<const N: usize>(
    values: impl Iterator<Item = f32> + Clone,
    parts: [f32; N],
) -> Option<[f32; N]> {
    let finite = || values.clone().filter(|value| value.is_finite());
    let (mut low, mut high, mut count) = (f32::MAX, f32::MIN, 0_u32);
    for value in finite() {
        low = low.min(value);
        high = high.max(value);
        count = count.saturating_add(1);
    }
    if count == 0 {
        return None;
    }
    let scale = nearest_f32(BINS) / (high - low).max(f32::MIN_POSITIVE);
    let mut histogram = [0_u32; BINS];
    for value in finite() {
        let bin = saturating_usize((value - low) * scale);
        if let Some(slot) = histogram.get_mut(bin.min(BINS - 1)) {
            *slot = slot.saturating_add(1);
        }
    }
    Some(parts.map(|part| {
        let wanted = saturating_u32(part * nearest_f32(count));
        let mut below = 0_u32;
        for (bin, number) in histogram.iter().enumerate() {
            below = below.saturating_add(*number);
            if below > wanted {
                // The middle of the bin; of a single value the value itself.
                return if high > low { low + (nearest_f32(bin) + 0.5) / scale } else { low };
            }
        }
        high
    }))
}

/// Median, and 1.4826 times the median distance from it: the standard deviation where the values are Gaussian.
pub(super) fn median_and_spread(values: impl Iterator<Item = f32> + Clone) -> Option<(f32, f32)> {
    let [median] = quantiles(values.clone(), [0.5])?;
    let [distance] = quantiles(values.map(|value| (value - median).abs()), [0.5])?;
    Some((median, 1.482_6 * distance))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn agrees_with_sorting_up_to_a_bin() {
        let mut random = floorguard_types::random::Pcg32::new(1, 1);
        let mut values: std::vec::Vec<f32> = (0..3_001).map(|_| random.normal()).collect();
        let found = quantiles(values.iter().copied(), [0.1, 0.5, 0.9]).unwrap();
        let (median, spread) = median_and_spread(values.iter().copied()).unwrap();
        values.sort_by(f32::total_cmp);
        for (value, index) in found.into_iter().zip([300, 1_500, 2_700]) {
            assert!((value - values[index]).abs() < 0.01);
        }
        assert!(median.abs() < 0.06 && (spread - 1.0).abs() < 0.06, "{median} {spread}");
    }

    #[test]
    fn hostile_values() {
        assert_eq!(quantiles([f32::NAN, f32::INFINITY].into_iter(), [0.5]), None);
        assert_eq!(quantiles([3.0, f32::NAN, 3.0].into_iter(), [0.5]), Some([3.0]));
    }
}
