//! Heat maps and places together: what the robot sees goes in here.

use floorguard_types::geometry::Point2;

use super::heat::{HeatCell, PeopleHeat};
use super::hour_table::HourEntry;
use super::place::Place;
use super::places::Places;
use super::visitors::PersonAt;
use super::wall_time::WallTime;

/// Samples older than the newest by more are refused: the clock was set (book, Environment: Calendar time), µs.
const BACKWARDS_US: i64 = 1_000_000;
/// Gaps longer than this are not watched, µs.
const WATCH_GAP_US: i64 = 10_000_000;

/// What became of a sighting.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[must_use]
pub enum Sighting {
    /// It was taken.
    Taken,
    /// It lies before what is known already; the clock was set back.
    TooOld,
}

/// The environment model.
#[derive(Clone, Debug)]
pub struct Environment<
    C,
    H,
    P,
    const HOURS: usize,
    const PERIODS: usize,
    const TRACKS: usize,
    const RECENT: usize,
> {
    /// Heat maps, 0.2 m.
    pub heat: PeopleHeat<C, H, TRACKS, RECENT>,
    /// Places, 2 m.
    pub places: Places<P, HOURS, PERIODS, TRACKS, RECENT>,
    newest: Option<WallTime>,
    watched_until: Option<WallTime>,
    refused: u32,
}

impl<C, H, P, const HOURS: usize, const PERIODS: usize, const TRACKS: usize, const RECENT: usize>
    Environment<C, H, P, HOURS, PERIODS, TRACKS, RECENT>
where
    C: AsRef<[HeatCell]> + AsMut<[HeatCell]>,
    H: AsRef<[HourEntry]> + AsMut<[HourEntry]>,
    P: AsRef<[Place<HOURS, PERIODS>]> + AsMut<[Place<HOURS, PERIODS>]>,
{
    /// From its parts. `newest` is when something was seen last, `None` for never.
    #[must_use]
    pub const fn new(
        heat: PeopleHeat<C, H, TRACKS, RECENT>,
        places: Places<P, HOURS, PERIODS, TRACKS, RECENT>,
        newest: Option<WallTime>,
    ) -> Self {
        Self { heat, places, newest, watched_until: None, refused: 0 }
    }

    /// When something was seen last.
    #[must_use]
    pub const fn newest(&self) -> Option<WallTime> {
        self.newest
    }

    /// Sightings that were refused because the clock had been set back.
    #[must_use]
    pub const fn refused(&self) -> u32 {
        self.refused
    }

    fn admit(&mut self, at: WallTime) -> Sighting {
        if self.newest.is_some_and(|newest| newest.micros_since(at) > BACKWARDS_US) {
            self.refused = self.refused.saturating_add(1);
            return Sighting::TooOld;
        }
        self.newest = self.newest.max(Some(at));
        Sighting::Taken
    }

    /// Takes the newest position of a track; the clock on the wall is `offset_s` ahead of UTC.
    pub fn observe(&mut self, person: PersonAt, at: WallTime, offset_s: i32) -> Sighting {
        let verdict = self.admit(at);
        if verdict == Sighting::Taken {
            self.heat.observe(person, at, offset_s);
            self.places.observe(person, at, offset_s);
        }
        verdict
    }

    /// What `is_in_sight` has been watched since the last call, if that is not longer ago than a few seconds. To be
    /// called about once a second, and once when watching begins.
    pub fn watch(
        &mut self,
        at: WallTime,
        offset_s: i32,
        mut is_in_sight: impl FnMut(Point2) -> bool,
    ) -> Sighting {
        let verdict = self.admit(at);
        if verdict == Sighting::TooOld {
            return verdict;
        }
        let since = self.watched_until.replace(at).unwrap_or(at);
        // Differences of rounded times: what is lost now is gained next time.
        let hundredths = |time: WallTime| time.as_micros().div_euclid(10_000);
        let gap_us = at.micros_since(since);
        if gap_us > 0 && gap_us <= WATCH_GAP_US {
            let watched_cs =
                u32::try_from(hundredths(at).saturating_sub(hundredths(since))).unwrap_or_default();
            self.heat.watch(watched_cs, &mut is_in_sight);
            self.places.watch((at, offset_s), watched_cs, &mut is_in_sight);
        }
        verdict
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::GridGeometry;
    use std::{vec, vec::Vec};

    type Small = Environment<Vec<HeatCell>, Vec<HourEntry>, Vec<Place<24, 12>>, 24, 12, 8, 32>;

    fn small() -> Small {
        let fine = GridGeometry::new(40, 40, 0.2, Point2::new(0.0, 0.0)).unwrap();
        let coarse = GridGeometry::new(4, 4, 2.0, Point2::new(0.0, 0.0)).unwrap();
        let heat =
            PeopleHeat::new(fine, vec![HeatCell::default(); 1_600], vec![HourEntry::NOTHING; 4_096]).unwrap();
        let places = Places::new(coarse, vec![Place::EMPTY; 16]).unwrap();
        Environment::new(heat, places, None)
    }

    #[test]
    fn watching_and_walking_reach_both_rasters() {
        let mut environment = small();
        for tenth in 0..20_000_i64 {
            let at = WallTime::from_micros(1_775_433_600_000_000 + tenth * 100_000);
            if tenth % 10 == 0 {
                assert_eq!(environment.watch(at, 0, |point| point.x_m < 4.0), Sighting::Taken);
            }
            // Every 50 s somebody crosses the room in 6 s.
            let step = tenth % 500;
            if step < 60 {
                let position_in_map = Point2::new(0.5 + step as f32 * 0.12, 3.0);
                let person = PersonAt { id: (tenth / 500) as u64, position_in_map };
                assert_eq!(environment.observe(person, at, 0), Sighting::Taken);
            }
        }
        environment.places.turn_to(WallTime::from_seconds(1_775_433_600 + 4_000), 0);
        let cell = *environment
            .heat
            .cells()
            .get(environment.heat.cells().geometry().cell_at(Point2::new(3.0, 3.0)).unwrap())
            .unwrap();
        assert_eq!(cell.visits, 40);
        assert!((cell.watched_hours() - 0.555).abs() < 0.01);
        let place = environment.places.grid().get(5).unwrap();
        let rate = place.forecast().rate(WallTime::from_seconds(1_775_433_600).local(0));
        assert!((rate.per_hour - 72.0).abs() < 30.0, "{rate:?}");
        assert!((place.stay_hours() * 3_600.0 - 1.7).abs() < 0.2, "{}", place.stay_hours());
    }

    #[test]
    fn a_clock_that_is_set_back_teaches_nothing() {
        let mut environment = small();
        let person = PersonAt { id: 1, position_in_map: Point2::new(1.0, 1.0) };
        assert_eq!(environment.observe(person, WallTime::from_seconds(1_000), 0), Sighting::Taken);
        assert_eq!(environment.observe(person, WallTime::from_micros(999_100_000), 0), Sighting::Taken);
        assert_eq!(environment.observe(person, WallTime::from_seconds(990), 0), Sighting::TooOld);
        assert_eq!(environment.watch(WallTime::from_seconds(990), 0, |_| true), Sighting::TooOld);
        assert_eq!((environment.refused(), environment.newest()), (2, Some(WallTime::from_seconds(1_000))));
    }
}
