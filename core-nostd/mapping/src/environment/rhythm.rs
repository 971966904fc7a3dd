//! The rhythm of a place: its mean, times what the hour of the day does, times what the weekday does.
//!
//! A plain histogram of the week needs months, and one of the day knows no Sunday. The product of 24 and 7 factors
//! needs days; each factor is believed as far as the data carry it, and what the product misses is put right hour by
//! hour ([`Correction`]).

use super::correction::{Correction, Count, Fit, HourlyVisits, shape};
use super::evidence::Rate;
use super::wall_time::LocalTime;
use super::week::{Evidence, Week};

/// Rounds in which the factors of hours and weekdays are separated.
const ROUNDS: usize = 3;

/// The factors of a place.
#[derive(Clone, Copy, Debug)]
pub struct Rhythm {
    mean: f32,
    hours: [f32; 24],
    days: [f32; 7],
}

impl Rhythm {
    /// From what was seen; `spread` ≥ 1 says how much more visits vary than independent people would.
    #[must_use]
    pub fn new<const HOURS: usize>(week: &Week<HOURS>, spread: f32) -> Self {
        let mut rhythm = Self { mean: Rate::mean_of(week.total()), hours: [1.0; 24], days: [1.0; 7] };
        for _ in 0..ROUNDS {
            let mut counts = [Count::default(); 24];
            rhythm.gather(week, &mut counts, |index| index % 24, Self::day);
            rhythm.hours = circle(&counts, spread);
            if HOURS > 24 {
                let mut counts = [Count::default(); 7];
                rhythm.gather(week, &mut counts, |index| index / 24 % 7, Self::hour);
                rhythm.days = shrink(&counts, spread);
            }
        }
        rhythm
    }

    /// Visits an hour in an hour of the week.
    #[must_use]
    pub fn base(&self, hour_of_week: usize) -> f32 {
        self.mean * self.hour(hour_of_week) * self.day(hour_of_week)
    }

    /// What is put right hour by hour.
    #[must_use]
    pub fn correction<const HOURS: usize>(&self, week: &Week<HOURS>, spread: f32) -> Correction {
        Correction::new(week, Fit { spread, fitted: 31.0 }, |index| self.base(index))
    }

    /// What to expect at a moment, put right.
    #[must_use]
    pub fn rate<const HOURS: usize>(
        &self,
        week: &Week<HOURS>,
        correction: &Correction,
        at: LocalTime,
    ) -> HourlyVisits {
        correction.apply(week, at, self.base(usize::from(at.hour_of_week())))
    }

    fn hour(&self, index: usize) -> f32 {
        self.hours.get(index % 24).copied().unwrap_or(1.0)
    }

    fn day(&self, index: usize) -> f32 {
        self.days.get(index / 24 % 7).copied().unwrap_or(1.0)
    }

    /// Sums visits, and what the mean and the other factor expect, into the places that `place` names.
    fn gather<const HOURS: usize, const N: usize>(
        &self,
        week: &Week<HOURS>,
        into: &mut [Count; N],
        place: impl Fn(usize) -> usize,
        other: impl Fn(&Self, usize) -> f32,
    ) {
        for (bin, index) in week.bins().iter().zip(0_usize..) {
            let seen = Evidence::from(bin);
            if let Some(count) = into.get_mut(place(index)) {
                count.seen += seen.visits;
                count.expected += self.mean * other(self, index) * seen.hours;
            }
        }
    }
}

/// Factors that share nothing but their mean, 1.
fn shrink<const N: usize>(counts: &[Count; N], spread: f32) -> [f32; N] {
    let shape = shape(counts.iter().map(|count| (*count, 1.0)), spread);
    counts.map(|count| (count.seen + shape) / (count.expected + shape))
}

/// Factors of the hours of the day: each leans on itself and its two neighbours together, as far as hours resemble
/// their neighbours here.
fn circle(counts: &[Count; 24], spread: f32) -> [f32; 24] {
    let around = |index: usize| {
        let of = |ahead: usize| counts.get(index.saturating_add(ahead) % 24).copied().unwrap_or_default();
        (of(23), of(0), of(1))
    };
    let against_neighbours = (0..24).map(|index| {
        let (before, own, after) = around(index);
        let (seen, expected) = (before.seen + after.seen, before.expected + after.expected);
        let factor = (seen + 0.5) / (expected + 0.5);
        (Count { seen: own.seen, expected: factor * own.expected }, 1.0 + own.expected / expected.max(0.1))
    });
    let shape = shape(against_neighbours, spread);
    let mut factors = [1.0; 24];
    for (factor, index) in factors.iter_mut().zip(0_usize..) {
        let (before, own, after) = around(index);
        let seen = before.seen + own.seen + after.seen;
        let prior = (seen + 0.5) / (before.expected + own.expected + after.expected + 0.5);
        *factor = (own.seen + shape) / (own.expected + shape / prior.max(0.01));
    }
    factors
}

#[cfg(test)]
#[path = "rhythm_tests.rs"]
mod tests;
