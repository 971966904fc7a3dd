//! Rhythms that are plain to see, and factors that can be worked out by hand.

use super::*;
use crate::environment::HourBin;

/// A Monday, 00:00.
const MONDAY_S: i64 = 4 * 86_400;

fn at(hour_of_week: i64) -> LocalTime {
    LocalTime::from_seconds(MONDAY_S + hour_of_week * 3_600)
}

/// `weeks` weeks of exactly the expected visits.
fn week(weeks: u16, rate: impl Fn(usize) -> u16) -> Week<168> {
    let mut bins = [HourBin::default(); 168];
    for (index, bin) in bins.iter_mut().enumerate() {
        *bin = HourBin { visits: rate(index) * weeks, watched_ds: u32::from(weeks) * 36_000 };
    }
    Week::from_bins(bins)
}

#[test]
fn product_of_hours_and_days_is_exact() {
    let rate = |index: usize| {
        let hour = if (8..18).contains(&(index % 24)) { 20 } else { 2 };
        if index / 24 < 5 { hour } else { hour / 2 }
    };
    let week = week(50, rate);
    let rhythm = Rhythm::new(&week, 1.0);
    let correction = rhythm.correction(&week, 1.0);
    for hour in 0..168 {
        let HourlyVisits { per_hour: value, watched_hours: hours } =
            rhythm.rate(&week, &correction, at(hour));
        let truth = f32::from(rate(hour as usize));
        assert!((value / truth - 1.0).abs() < 0.02, "{hour}: {value} for {truth}");
        assert!((50.0..=350.0).contains(&hours), "{hours}");
    }
}

#[test]
fn frequent_residuals_correct_the_product() {
    // A market on Thursday mornings only.
    let rate = |index: usize| if index / 24 == 3 && (6..12).contains(&(index % 24)) { 60 } else { 3 };
    let week = week(30, rate);
    let rhythm = Rhythm::new(&week, 1.0);
    let correction = rhythm.correction(&week, 1.0);
    assert!(rhythm.base(3 * 24 + 20) > 5.0, "the product takes the whole Thursday for busy");
    for (hour, truth) in [(3 * 24 + 8, 60.0), (3 * 24 + 20, 3.0), (2 * 24 + 8, 3.0), (10, 3.0)] {
        let value = rhythm.rate(&week, &correction, at(hour)).per_hour;
        assert!((value - truth).abs() < 0.15 * truth, "{hour}: {value} for {truth}");
    }
}

#[test]
fn little_data_say_little() {
    let one_hour = {
        let mut bins = [HourBin::default(); 168];
        bins[9] = HourBin { visits: 4, watched_ds: 36_000 };
        Week::<168>::from_bins(bins)
    };
    let rhythm = Rhythm::new(&one_hour, 1.0);
    let correction = rhythm.correction(&one_hour, 1.0);
    let HourlyVisits { per_hour: value, watched_hours: hours } = rhythm.rate(&one_hour, &correction, at(9));
    assert!((value - 3.4).abs() < 0.7 && hours <= 1.0, "{value} {hours}");
    let HourlyVisits { per_hour: elsewhere, watched_hours: hours } =
        rhythm.rate(&one_hour, &correction, at(100));
    assert!((elsewhere - 3.4).abs() < 0.7, "{elsewhere}");
    assert_eq!(hours, 0.0);
    let nothing = Week::<24>::EMPTY;
    let rhythm = Rhythm::new(&nothing, 1.0);
    assert!(rhythm.rate(&nothing, &rhythm.correction(&nothing, 1.0), at(0)).per_hour.is_finite());
}

/// Counts of variance 100 + 20² around 100: α is (100/20)² = 25.
#[test]
fn spread_of_counts_gives_the_shape() {
    let counts = [78.0, 122.0, 78.0, 122.0, 80.0, 120.0].map(|seen| (Count { seen, expected: 100.0 }, 1.0));
    let excess: f32 = counts.iter().map(|(count, _)| (count.seen - 100.0).powi(2) - 100.0).sum::<f32>() / 6.0;
    assert!((shape(counts.into_iter(), 1.0) - 10_000.0 / excess).abs() < 1e-3);
    assert_eq!(shape([(Count { seen: 100.0, expected: 100.0 }, 1.0)].into_iter(), 1.0), 500.0);
    assert_eq!(shape(core::iter::empty(), 1.0), 500.0);
}
