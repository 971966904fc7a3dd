//! How fast a place gets dirty: estimated from the dirt that was picked up there and, before there is any, from the
//! people who come (book, Environment: Dirt by place).
//!
//! What a visitor leaves is learned from all places together, so a place that was never cleaned is expected to be as
//! dirty as its visitors make the others.

use crate::{DirtRate, RunObservation};

use super::evidence::Rate;
use super::place::Place;
use super::wall_time::WallTime;

/// What people say about the dirt of a place is worth at most this many hours of cleaning up after them, and this many
/// units: visitors of one place may well leave half or twice as much as those of another.
const PEOPLE_HOURS: f32 = 1.0;
const PEOPLE_UNITS: f32 = 4.0;
/// A pass that was expected to pick up less of a place's dirt says nothing about it.
const SHARE_MIN: f32 = 0.05;
/// What was expected of a place is worth this many units of evidence beside what was picked up.
const EXPECTED_UNITS: f32 = 20.0;
/// Places watched for less do not tell how many visitors they have, h.
const WATCHED_HOURS_MIN: f32 = 1.0;

/// Dirt picked up in a place.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct DirtSeen {
    /// Units that had arrived.
    pub units: f32,
    /// In this many hours, each counted by the share of the dirt that was picked up.
    pub hours: f32,
}

/// What a visitor leaves, over all places of a map.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DirtPerVisit {
    /// Units.
    pub units: f32,
    /// Left by this many visitors.
    pub visits: f32,
}

impl Default for DirtPerVisit {
    fn default() -> Self {
        Self::PRIOR
    }
}

impl DirtPerVisit {
    /// One unit for twenty visitors, worth no more than that: an assumption until dirt has been measured.
    pub const PRIOR: Self = Self { units: 1.0, visits: 20.0 };

    /// Units a visitor.
    #[must_use]
    pub fn mean(&self) -> f32 {
        self.units / self.visits.max(f32::MIN_POSITIVE)
    }

    /// Dirt has been measured at all.
    #[must_use]
    pub fn is_learned(&self) -> bool {
        *self != Self::PRIOR
    }
}

/// A cleaning of a place.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cleaning {
    /// When it ended.
    pub at: WallTime,
    /// Units picked up.
    pub units: f32,
    /// Share of the place's dirt that was expected to be picked up, within [0, 1].
    pub share: f32,
}

/// How a place was left.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SinceCleaning {
    /// Since the last cleaning, ≥ 0.
    pub hours: f32,
    /// Dirt that it left, units.
    pub left_units: f32,
}

impl<const HOURS: usize, const PERIODS: usize> Place<HOURS, PERIODS> {
    /// It was watched long enough to tell how many visitors it has.
    #[must_use]
    pub fn is_watched(&self) -> bool {
        self.week.total().hours >= WATCHED_HOURS_MIN
    }

    /// How fast dirt arrives: from the people who come, put right by what was picked up.
    #[must_use]
    pub fn dirt_rate(&self, per_visit: &DirtPerVisit) -> DirtRate {
        let seen = self.week.total();
        let by_people = if self.is_watched() {
            let per_hour = per_visit.mean() * Rate::mean_of(seen);
            DirtRate::from_expectation(per_hour, PEOPLE_HOURS.min(PEOPLE_UNITS / per_hour.max(1.0e-6)))
        } else {
            // One unit a day, the usual prior, but no more than a hint: a day's weight would halve what the first day
            // shows.
            DirtRate { shape: DirtRate::PRIOR.shape / DirtRate::PRIOR.hours, hours: 1.0 }
        };
        DirtRate { shape: by_people.shape + self.dirt.units, hours: by_people.hours + self.dirt.hours }
    }

    /// The last cleaning; without one on record, one a day ago that left nothing.
    #[must_use]
    pub fn since_cleaning(&self, now: WallTime) -> SinceCleaning {
        self.cleaned.map_or(SinceCleaning { hours: 24.0, left_units: 0.0 }, |(at, left_units)| {
            SinceCleaning { hours: now.hours_since(at).max(0.0), left_units }
        })
    }

    /// Dirt expected now: what the last cleaning left, and what has arrived since.
    #[must_use]
    pub fn expected_dirt(&self, now: WallTime, per_visit: &DirtPerVisit) -> f32 {
        let SinceCleaning { hours, left_units } = self.since_cleaning(now);
        self.dirt_rate(per_visit).predict(left_units, hours)
    }

    /// Units that lay there before a cleaning: what was expected, put right by what was picked up. A pass over a
    /// corner of the place must not decide for all of it.
    fn lay_there(&self, cleaning: Cleaning, per_visit: &DirtPerVisit) -> f32 {
        let Cleaning { at, units, share } = cleaning;
        if self.cleaned.is_none() || self.dirt.hours <= 0.0 {
            return units / share;
        }
        let expected = self.expected_dirt(at, per_visit).max(1.0e-3);
        (EXPECTED_UNITS + units) / (EXPECTED_UNITS / expected + share)
    }

    /// Learns from a cleaning how fast the place gets dirty, and what a visitor leaves. The first one only sets the
    /// clock: nobody knows since when its dirt had been lying there.
    pub fn learn_cleaning(&mut self, cleaning: Cleaning, per_visit: &mut DirtPerVisit) {
        let Cleaning { at, units, share } = cleaning;
        if !(units >= 0.0 && units.is_finite() && share >= SHARE_MIN) {
            return;
        }
        let share = share.min(1.0);
        let cleaning = Cleaning { at, units, share };
        let lay_there = self.lay_there(cleaning, per_visit);
        if let Some((last, left)) = self.cleaned {
            let hours_since_cleaning = at.hours_since(last);
            let arrived = (units - left * share).max(0.0);
            let run = RunObservation { hours_since_cleaning, measured_units: arrived, observed_share: share };
            let faded =
                DirtRate { shape: self.dirt.units, hours: self.dirt.hours }.forget(DirtRate::FORGETTING);
            let learned = faded.observe(run);
            self.dirt = DirtSeen { units: learned.shape, hours: learned.hours };
            let seen = self.week.total();
            if self.is_watched() && hours_since_cleaning > 0.0 {
                per_visit.units += arrived;
                per_visit.visits += Rate::mean_of(seen) * hours_since_cleaning * share;
            }
        }
        self.cleaned = Some((at, lay_there * (1.0 - share)));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    type Room = Place<24, 12>;

    /// A Monday, 00:00 UTC.
    const MONDAY_S: i64 = 1_775_433_600;

    /// Ten visitors an hour, watched for two days.
    fn visited() -> Room {
        let mut place = Room::EMPTY;
        for slice in 0..288 {
            let at = WallTime::from_seconds(MONDAY_S + slice * 600);
            place.watch((at, 0), 60_000);
            (0..if slice % 3 == 0 { 1 } else { 2 }).for_each(|_| place.note((at, 0), true, 20));
        }
        place.close(0);
        place
    }

    #[test]
    fn people_predict_dirt_until_it_is_measured() {
        let mut per_visit = DirtPerVisit::PRIOR;
        let mut place = visited();
        assert!((place.dirt_rate(&per_visit).units_per_hour() - 0.5).abs() < 0.01);
        assert_eq!(Room::EMPTY.dirt_rate(&per_visit).units_per_hour(), DirtRate::PRIOR.units_per_hour());
        // Every evening 96 units are picked up, four an hour, where 12 were expected.
        for day in 0..20 {
            let at = WallTime::from_seconds(MONDAY_S + day * 86_400 + 79_200);
            place.learn_cleaning(Cleaning { at, units: 96.0, share: 1.0 }, &mut per_visit);
        }
        assert!((place.dirt_rate(&per_visit).units_per_hour() - 4.0).abs() < 0.1, "{:?}", place.dirt);
        assert!((per_visit.mean() - 0.4).abs() < 0.01, "{per_visit:?}");
        // Another place with as many visitors, never cleaned.
        assert!((visited().dirt_rate(&per_visit).units_per_hour() - 4.0).abs() < 0.1);
    }

    #[test]
    fn left_dirt_is_expected_not_counted_twice() {
        let mut per_visit = DirtPerVisit::PRIOR;
        let mut place = visited();
        let at = |hours: i64| WallTime::from_seconds(MONDAY_S + hours * 3_600);
        place.learn_cleaning(Cleaning { at: at(0), units: 30.0, share: 0.5 }, &mut per_visit);
        assert_eq!(place.cleaned, Some((at(0), 30.0)));
        assert_eq!(place.dirt, DirtSeen::default(), "the first cleaning only sets the clock");
        assert!((place.expected_dirt(at(10), &per_visit) - 35.0).abs() < 0.2);
        // 30 left and 10 arrived; half of it is picked up.
        place.learn_cleaning(Cleaning { at: at(10), units: 20.0, share: 0.5 }, &mut per_visit);
        assert_eq!(place.dirt, DirtSeen { units: 5.0, hours: 5.0 });
    }

    #[test]
    fn nonsense_teaches_nothing() {
        let mut per_visit = DirtPerVisit::PRIOR;
        let mut place = visited();
        let before = place;
        for (units, share) in
            [(f32::NAN, 1.0), (1.0, f32::NAN), (-1.0, 1.0), (1.0, 0.01), (f32::INFINITY, 1.0)]
        {
            place.learn_cleaning(Cleaning { at: WallTime::default(), units, share }, &mut per_visit);
        }
        assert_eq!((place, per_visit), (before, DirtPerVisit::PRIOR));
    }
}
