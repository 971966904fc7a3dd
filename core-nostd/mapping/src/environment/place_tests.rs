//! A place with office hours, watched for weeks.

use super::super::evidence::Confidence;
use super::*;
use floorguard_types::random::Pcg32;

type Office = Place<168, 84>;

/// A Monday, 00:00 UTC.
const MONDAY_S: i64 = 1_775_433_600;

fn true_rate(local: LocalTime) -> f32 {
    if local.weekday() < 5 && (8..18).contains(&local.hour()) { 12.0 } else { 0.2 }
}

/// Poisson visits in every slice in which `is_watched`.
fn watched(weeks: i64, is_watched: impl Fn(LocalTime) -> bool) -> Office {
    let mut random = Pcg32::new(4, 0);
    let mut place = Office::default();
    for slice in 0..weeks * 1_008 {
        let at = WallTime::from_seconds(MONDAY_S + slice * SLICE_S + 300);
        let local = at.local(0);
        if !is_watched(local) {
            continue;
        }
        place.watch((at, 0), 60_000);
        let mut wait = random.exponential(true_rate(local) / 6.0);
        for _ in 0..50 {
            if wait > 1.0 {
                break;
            }
            place.note((at, 0), true, 20);
            wait += random.exponential(true_rate(local) / 6.0);
        }
    }
    place.turn_to(WallTime::from_seconds(MONDAY_S + weeks * 604_800 + SLICE_S), 0);
    place
}

trait Exponential {
    fn exponential(&mut self, rate: f32) -> f32;
}

impl Exponential for Pcg32 {
    fn exponential(&mut self, rate: f32) -> f32 {
        -libm::logf(1.0 - self.uniform_between(0.0, 0.999_999)) / rate
    }
}

#[test]
fn learns_the_hours_of_the_week() {
    let place = watched(4, |_| true);
    let forecast = place.forecast();
    assert!((forecast.watched_hours() - 672.0).abs() < 0.1);
    let rate = |hours: i64| forecast.rate(WallTime::from_seconds(MONDAY_S + hours * 3_600).local(0));
    let (noon, night, saturday) = (rate(12), rate(3), rate(5 * 24 + 12));
    assert!(
        (noon.per_hour - 12.0).abs() < 3.0 && noon.low < 12.0 && noon.high > 12.0,
        "{noon:?} {forecast:?}"
    );
    assert!(night.per_hour < 1.5 && saturday.per_hour < 1.5, "{night:?} {saturday:?}");
    assert_eq!(forecast.model(), RateModel::Rhythm);
    assert!((place.stay_hours() * 3_600.0 - 2.0).abs() < 0.01);
}

#[test]
fn unseen_hour_is_guess_unseen_place_unknown() {
    let place = watched(2, |local| local.hour() < 7);
    let noon = place.forecast().rate(WallTime::from_seconds(MONDAY_S + 12 * 3_600).local(0));
    assert_eq!(noon.confidence(), Confidence::Guess);
    let nothing = Office::default();
    assert_eq!(nothing.forecast().rate(LocalTime::from_seconds(0)).confidence(), Confidence::Unknown);
}

#[test]
fn short_watch_without_visitors_is_weak_evidence() {
    let mut place = Office::default();
    let at = WallTime::from_seconds(MONDAY_S);
    place.watch((at, 0), 6_000);
    place.turn_to(at.plus_micros(900_000_000), 0);
    let rate = place.forecast().rate(at.local(0));
    assert_eq!(rate.confidence(), Confidence::Guess);
    assert!(rate.high > 3.0, "{rate:?}");
}

#[test]
fn the_sizes_of_both_profiles() {
    // Capacities: 64 × 12 on the target, 4,096 × 24 hosted.
    assert!(core::mem::size_of::<Place<24, 12>>() <= 640, "{}", core::mem::size_of::<Place<24, 12>>());
    assert!(core::mem::size_of::<Office>() <= 2_880, "{}", core::mem::size_of::<Office>());
}
