//! Median, 99th percentile and maximum of a set of times.

use serde::Serialize;

/// Order statistics, milliseconds; zero when nothing was measured.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct Quantiles {
    /// Half are at most this.
    pub median: f64,
    /// 99 of 100 are at most this.
    pub p99: f64,
    /// The largest.
    pub max: f64,
    /// How many there were.
    pub count: usize,
}

impl Quantiles {
    /// Of times in microseconds (nearest-rank method).
    #[must_use]
    pub fn of_micros(mut times_us: Vec<u64>) -> Self {
        times_us.sort_unstable();
        let count = times_us.len();
        let at = |share: f64| {
            let rank = (share * count as f64).ceil().max(1.0) as usize;
            times_us.get(rank - 1).map_or(0.0, |time_us| *time_us as f64 / 1_000.0)
        };
        Self { median: at(0.5), p99: at(0.99), max: at(1.0), count }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn nearest_rank() {
        let quantiles = Quantiles::of_micros((1..=200).map(|n| n * 1_000).rev().collect());
        assert_eq!(quantiles, Quantiles { median: 100.0, p99: 198.0, max: 200.0, count: 200 });
        assert_eq!(Quantiles::of_micros(Vec::new()), Quantiles::default());
    }
}
