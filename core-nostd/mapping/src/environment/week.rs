//! Visits and watched time for every hour of the week or of the day: the plain histogram (book, Environment:
//! Histogram).

use floorguard_types::number::nearest_f32;

use super::wall_time::LocalTime;

/// What supports a rate: visits seen in hours watched.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Evidence {
    /// Visits.
    pub visits: f32,
    /// Hours watched.
    pub hours: f32,
}

impl Evidence {
    fn plus(self, other: Self, share: f32) -> Self {
        Self { visits: self.visits + share * other.visits, hours: self.hours + share * other.hours }
    }
}

/// One hour of the week.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct HourBin {
    /// Visits.
    pub visits: u16,
    /// Time watched, tenths of a second.
    pub watched_ds: u32,
}

/// Visits and watched time, hour by hour: `HOURS` is 168 for a week, or 24 where memory is short.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Week<const HOURS: usize> {
    bins: [HourBin; HOURS],
}

impl<const HOURS: usize> Default for Week<HOURS> {
    fn default() -> Self {
        Self::EMPTY
    }
}

impl<const HOURS: usize> Week<HOURS> {
    /// Nothing seen.
    pub const EMPTY: Self = Self { bins: [HourBin { visits: 0, watched_ds: 0 }; HOURS] };

    /// The bins, from Monday 00:00.
    #[must_use]
    pub const fn bins(&self) -> &[HourBin; HOURS] {
        &self.bins
    }

    /// A week from its bins.
    #[must_use]
    pub const fn from_bins(bins: [HourBin; HOURS]) -> Self {
        Self { bins }
    }

    /// Takes what was seen in a part of an hour. A bin that is full halves its past: the rate stays, and fades.
    pub fn add(&mut self, at: LocalTime, visits: u16, watched_ds: u32) {
        if let Some(bin) = self.bins.get_mut(Self::place(usize::from(at.hour_of_week()))) {
            if bin.visits.checked_add(visits).is_none() || bin.watched_ds.checked_add(watched_ds).is_none() {
                *bin = HourBin { visits: bin.visits / 2, watched_ds: bin.watched_ds / 2 };
            }
            bin.visits = bin.visits.saturating_add(visits);
            bin.watched_ds = bin.watched_ds.saturating_add(watched_ds);
        }
    }

    fn place(hour: usize) -> usize {
        hour.checked_rem(HOURS).unwrap_or_default()
    }

    /// Everything.
    #[must_use]
    pub fn total(&self) -> Evidence {
        self.bins.iter().fold(Evidence::default(), |sum, bin| sum.plus(bin.into(), 1.0))
    }

    /// What was seen around this hour of this weekday: the hour with half weight, its neighbours with a quarter each,
    /// round the week.
    #[must_use]
    pub fn around(&self, at: LocalTime) -> Evidence {
        let hour = usize::from(at.hour_of_week());
        [(HOURS.saturating_sub(1), 0.25), (0, 0.5), (1, 0.25)].iter().fold(
            Evidence::default(),
            |sum, (ahead, share)| {
                let bin = self.bins.get(Self::place(hour.saturating_add(*ahead)));
                sum.plus(bin.map(Evidence::from).unwrap_or_default(), *share)
            },
        )
    }

    /// The same for the hour of the day, all weekdays together.
    #[must_use]
    pub fn around_any_day(&self, at: LocalTime) -> Evidence {
        let hour = usize::from(at.hour());
        [(23_usize, 0.25), (0, 0.5), (1, 0.25)].iter().fold(Evidence::default(), |sum, (ahead, share)| {
            let same = hour.saturating_add(*ahead) % 24;
            self.bins.iter().skip(same).step_by(24).fold(sum, |sum, bin| sum.plus(bin.into(), *share))
        })
    }
}

impl From<&HourBin> for Evidence {
    fn from(bin: &HourBin) -> Self {
        Self { visits: f32::from(bin.visits), hours: nearest_f32(bin.watched_ds) * (1.0 / 36_000.0) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn neighbours_share_and_the_week_is_a_circle() {
        let mut week = Week::<168>::default();
        // 1970-01-05 was a Monday.
        let monday = LocalTime::from_seconds(4 * 86_400);
        week.add(monday, 8, 36_000);
        assert_eq!(week.around(monday), Evidence { visits: 4.0, hours: 0.5 });
        let sunday_night = LocalTime::from_seconds(4 * 86_400 - 1);
        assert_eq!(week.around(sunday_night), Evidence { visits: 2.0, hours: 0.25 });
        assert_eq!(week.around_any_day(LocalTime::from_seconds(0)), Evidence { visits: 4.0, hours: 0.5 });
        assert_eq!(week.total(), Evidence { visits: 8.0, hours: 1.0 });
    }

    #[test]
    fn a_full_bin_keeps_its_rate() {
        let mut week = Week::<168>::default();
        let at = LocalTime::from_seconds(0);
        for _ in 0..10_000 {
            week.add(at, 20, 36_000);
        }
        let total = week.total();
        assert!((total.visits / total.hours - 20.0).abs() < 0.1, "{total:?}");
    }
}
