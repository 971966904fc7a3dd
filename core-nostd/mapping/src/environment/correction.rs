//! What is particular to an hour of the week, beyond what a coarser formula expects of it.
//!
//! An hour's factor has a Gamma(α, α) law, and α is estimated from the data: as much as the counts of the hours vary
//! more around the formula than Poisson counts would (empirical Bayes, by moments). Then f = (V + α)/(E + α), with V
//! visits where E were expected: little data stay with the formula, much data speak for themselves, and a formula that
//! does not fit is believed no more than it deserves.

use floorguard_types::number::nearest_f32;

use super::evidence::Rate;
use super::wall_time::LocalTime;
use super::week::{Evidence, Week};

/// Bounds of α: counts that vary at will, and counts that do not vary at all.
pub const SHAPE: (f32, f32) = (0.02, 500.0);

/// Visits, and those expected.
#[derive(Clone, Copy, Debug, Default)]
pub struct Count {
    /// Seen.
    pub seen: f32,
    /// Expected.
    pub expected: f32,
}

/// α by moments: how much counts vary around what was expected beyond `spread` times Poisson. Each count comes with
/// what its expectation's own doubt adds to the variance, as a factor.
pub fn shape(counts: impl Iterator<Item = (Count, f32)>, spread: f32) -> f32 {
    let (mut excess, mut square) = (0.0_f32, 0.0_f32);
    for (Count { seen, expected }, doubt) in counts {
        let error = seen - expected;
        excess += error * error - spread * doubt * expected;
        square += expected * expected;
    }
    if excess > 0.0 { (square / excess).clamp(SHAPE.0, SHAPE.1) } else { SHAPE.1 }
}

/// The factors of the hours of a week around a formula.
#[derive(Clone, Copy, Debug)]
pub struct Correction {
    /// α of the hours below half the mean rate, and of the others: a formula that is right about the crowd may be
    /// wrong about the night by its own measure.
    shapes: (f32, f32),
    calm: f32,
    /// Hours watched at each hour of the day.
    watched: [f32; 24],
}

/// How well a formula of visits may fit its own counts.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Fit {
    /// Variance of counts over that of Poisson's.
    pub spread: f32,
    /// Numbers of the formula that came from these counts.
    pub fitted: f32,
}

/// Visits to be expected, and how much they rest on.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct HourlyVisits {
    /// Visits an hour, > 0.
    pub per_hour: f32,
    /// Hours of watching that this rests on.
    pub watched_hours: f32,
}

impl Correction {
    /// Around `base`, visits an hour by the hour of the week.
    pub fn new<const HOURS: usize>(
        week: &Week<HOURS>,
        Fit { spread, fitted }: Fit,
        base: impl Fn(usize) -> f32,
    ) -> Self {
        let calm = 0.5 * Rate::mean_of(week.total());
        let mut watched = [0.0_f32; 24];
        for (bin, index) in week.bins().iter().zip(0_usize..) {
            if let Some(watched) = watched.get_mut(index % 24) {
                *watched += Evidence::from(bin).hours;
            }
        }
        let counts = |is_calm: bool| {
            let bins =
                week.bins().iter().zip(0_usize..).map(|(bin, index)| (Evidence::from(bin), base(index)));
            bins.filter(move |(_, rate)| (*rate < calm) == is_calm)
                .map(|(seen, rate)| (Count { seen: seen.visits, expected: rate * seen.hours }, 1.0))
        };
        let free = spread * (1.0 - fitted / nearest_f32(HOURS).max(fitted + 1.0));
        Self { shapes: (shape(counts(true), free), shape(counts(false), free)), calm, watched }
    }

    /// What to expect at a moment, of which the formula expects `base` visits an hour.
    pub fn apply<const HOURS: usize>(&self, week: &Week<HOURS>, at: LocalTime, base: f32) -> HourlyVisits {
        let index = usize::from(at.hour_of_week());
        let bin = week.bins().get(index.checked_rem(HOURS).unwrap_or_default()).map(Evidence::from);
        let seen = bin.unwrap_or_default();
        let base = base.max(1e-4);
        let shape = if base < self.calm { self.shapes.0 } else { self.shapes.1 };
        let factor = (seen.visits + shape) / (base * seen.hours + shape);
        // The formula is worth α visits, but not more than what was watched at the same hour of other days.
        let watched = self.watched.get(index % 24).copied().unwrap_or_default();
        let lent = (shape / base).min((watched - seen.hours).max(0.0));
        HourlyVisits { per_hour: base * factor, watched_hours: seen.hours + lent }
    }
}
