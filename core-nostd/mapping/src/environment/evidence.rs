//! A rate with its doubt, and the word for it.

use super::week::Evidence;

/// Two-sided 95 % of the normal law, halved by the square-root transform.
const HALF_Z: f32 = 0.98;
/// What an hour of the week is shrunk towards its place's mean with.
const BIN_PRIOR_HOURS: f32 = 1.0;
/// What a place counts as before it was watched: one visit an hour (book, Environment: Histogram), but worth a quarter
/// of an hour only, or a busy place that was watched for ten minutes would pass for a quiet one.
const PLACE_PRIOR: Evidence = Evidence { visits: 0.25, hours: 0.25 };

/// How much an answer is worth.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Confidence {
    /// Not observed: not the same as empty.
    Unknown,
    /// Watched, but for less than one hour.
    Guess,
    /// The truth may well be half or twice as much.
    Fair,
    /// Known within a factor of about one and a half, or known to be rare.
    Sure,
}

impl Confidence {
    /// The word.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Unknown => "unknown",
            Self::Guess => "guess",
            Self::Fair => "fair",
            Self::Sure => "sure",
        }
    }
}

/// Visits an hour, with a 95 % interval and what supports them.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Rate {
    /// Visits an hour, ≥ 0.
    pub per_hour: f32,
    /// Lower end of the interval.
    pub low: f32,
    /// Upper end of the interval.
    pub high: f32,
    /// Hours watched that the rate rests on; 0 for unknown.
    pub hours: f32,
}

impl Rate {
    /// The rate of one bin of a histogram: shrunk towards `usual`, the mean of the place, by as much as one hour of
    /// watching is worth. `spread` ≥ 1 says how much more visits vary than independent people would.
    #[must_use]
    pub fn of(seen: Evidence, usual: f32, spread: f32) -> Self {
        let hours = seen.hours.max(0.0) + BIN_PRIOR_HOURS;
        Self::with_doubt(
            (seen.visits.max(0.0) + usual.max(0.0) * BIN_PRIOR_HOURS) / hours,
            seen.hours,
            spread,
        )
    }

    /// The mean rate of a place, with a weak prior.
    #[must_use]
    pub fn mean_of(seen: Evidence) -> f32 {
        (seen.visits.max(0.0) + PLACE_PRIOR.visits) / (seen.hours.max(0.0) + PLACE_PRIOR.hours)
    }

    /// A predicted rate that rests on `hours` of watching. The interval is that of a Poisson count by the square-root
    /// transform (Anscombe), widened by the spread.
    #[must_use]
    pub fn with_doubt(per_hour: f32, hours: f32, spread: f32) -> Self {
        if !(per_hour.is_finite() && hours > 0.0 && hours.is_finite()) {
            return Self::default();
        }
        let per_hour = per_hour.max(0.0);
        let spread = if spread > 1.0 { spread.min(100.0) } else { 1.0 };
        // `spread` visits that come together count as one.
        let independent = hours / spread;
        let root = libm::sqrtf(per_hour * independent + 0.375);
        let low = (root - HALF_Z).max(0.0);
        let high = root + HALF_Z;
        Self {
            per_hour,
            low: ((low * low - 0.375) / independent).clamp(0.0, per_hour),
            high: ((high * high - 0.375) / independent).max(per_hour),
            hours,
        }
    }

    /// Probability that somebody comes within `hours`, if they come independently.
    #[must_use]
    pub fn presence(&self, hours: f32) -> f32 {
        1.0 - libm::expf(-(self.per_hour * hours.max(0.0)))
    }

    /// The word for it. A rate is also known well if even its upper end is rarer than one visit in two hours.
    #[must_use]
    pub fn confidence(&self) -> Confidence {
        if self.hours <= 0.0 {
            Confidence::Unknown
        } else if self.hours < 1.0 {
            Confidence::Guess
        } else if self.high <= 0.5 || self.high <= 1.5 * self.low.max(self.per_hour / 1.5) {
            Confidence::Sure
        } else {
            Confidence::Fair
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn unwatched_is_unknown_and_not_empty() {
        assert_eq!(Rate::of(Evidence::default(), 3.0, 1.0).confidence(), Confidence::Unknown);
        assert_eq!(Rate::mean_of(Evidence::default()), 1.0);
        assert_eq!(Rate::mean_of(Evidence { visits: 0.0, hours: 2.25 }), 0.1);
        assert_eq!(Rate::with_doubt(f32::NAN, 1.0, 1.0), Rate::default());
    }

    /// SciPy 1.17: `chi2.ppf(.025, 2*k)/2`, `chi2.ppf(.975, 2*(k+1))/2` are 4.795, 18.390 for k = 10 and
    /// 81.364, 121.627 for k = 100, the exact and therefore slightly wider intervals.
    #[test]
    fn intervals_are_those_of_poisson_counts() {
        let ten = Rate::with_doubt(10.0, 1.0, 1.0);
        assert!((ten.low - 4.795).abs() < 0.5 && (ten.high - 18.39).abs() < 1.2, "{ten:?}");
        let hundred = Rate::with_doubt(100.0, 1.0, 1.0);
        assert!((hundred.low - 81.364).abs() < 0.6 && (hundred.high - 121.627).abs() < 1.1, "{hundred:?}");
        let grouped = Rate::with_doubt(100.0, 1.0, 4.0);
        assert!(grouped.high - grouped.low > 1.9 * (hundred.high - hundred.low));
    }

    #[test]
    fn more_watching_is_surer() {
        let words = [0.0, 0.5, 2.0, 400.0].map(|hours| Rate::with_doubt(4.0, hours, 1.0).confidence());
        assert_eq!(words, [Confidence::Unknown, Confidence::Guess, Confidence::Fair, Confidence::Sure]);
        assert!((Rate::with_doubt(6.0, 9.0, 1.0).presence(1.0 / 6.0) - 0.632_120_6).abs() < 1e-6);
    }
}
