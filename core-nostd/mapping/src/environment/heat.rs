//! Heat maps of people: how many tracks passed a cell, and how long people were there (book, Environment: Heat maps).

use crate::{Grid, GridGeometry, GridTooSmall};
use floorguard_types::geometry::Point2;
use floorguard_types::number::nearest_f32;

use super::hour_table::{HourEntry, HourTable};
use super::visitors::{Footprint, PersonAt, Visitors};
use super::wall_time::{HOURS_OF_WEEK, WallTime};

/// Edge of a cell, metres (book, Environment: Heat maps).
pub const HEAT_CELL_M: f32 = 0.2;
const HUNDREDTH_US: u32 = 10_000;

/// What is known of one cell over all times.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct HeatCell {
    /// Tracks that entered.
    pub visits: u32,
    /// Time people spent, hundredths of a second.
    pub dwell_cs: u32,
    /// Time watched, hundredths of a second.
    pub watched_cs: u32,
}

impl HeatCell {
    /// Hours watched.
    #[must_use]
    pub fn watched_hours(&self) -> f32 {
        nearest_f32(self.watched_cs) * (1.0 / 360_000.0)
    }

    /// Visits an hour watched, with a Gamma(1, 1 h) prior; `None` if nobody ever looked (book, Environment: Heat maps).
    #[must_use]
    pub fn visits_per_hour(&self) -> Option<f32> {
        (self.watched_cs > 0).then(|| (nearest_f32(self.visits) + 1.0) / (self.watched_hours() + 1.0))
    }

    /// People there at a moment, on average: time spent by time watched; `None` if never observed.
    #[must_use]
    pub fn people(&self) -> Option<f32> {
        (self.watched_cs > 0).then(|| nearest_f32(self.dwell_cs) / nearest_f32(self.watched_cs))
    }
}

/// The heat maps: cells in storage `C`, hours in storage `H`.
#[derive(Clone, Debug)]
pub struct PeopleHeat<C, H, const TRACKS: usize, const RECENT: usize> {
    cells: Grid<HeatCell, C>,
    hours: HourTable<H>,
    visitors: Visitors<TRACKS, RECENT>,
    /// Time spent that is not yet a hundredth of a second.
    rest_us: u32,
}

/// What happened in a cell during some hours of the week.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct HourCount {
    /// People who came.
    pub visits: u32,
    /// How long they stayed together, hundredths of a second.
    pub dwell_cs: u32,
}

impl<C, H, const TRACKS: usize, const RECENT: usize> PeopleHeat<C, H, TRACKS, RECENT>
where
    C: AsRef<[HeatCell]> + AsMut<[HeatCell]>,
    H: AsRef<[HourEntry]> + AsMut<[HourEntry]>,
{
    /// Empty maps over a raster; what `hours` holds is cleared.
    ///
    /// # Errors
    /// The storage of the cells is too small.
    pub fn new(geometry: GridGeometry, cells: C, hours: H) -> Result<Self, GridTooSmall> {
        let mut cells = Grid::new(geometry, cells)?;
        cells.values_mut().fill(HeatCell::default());
        Ok(Self { cells, hours: HourTable::new(hours), visitors: Visitors::default(), rest_us: 0 })
    }

    /// All times together.
    #[must_use]
    pub const fn cells(&self) -> &Grid<HeatCell, C> {
        &self.cells
    }

    /// The same, to be restored from a file.
    pub const fn cells_mut(&mut self) -> &mut Grid<HeatCell, C> {
        &mut self.cells
    }

    /// Hour by hour.
    #[must_use]
    pub const fn hours(&self) -> &HourTable<H> {
        &self.hours
    }

    /// The same, to be restored from a file.
    pub const fn hours_mut(&mut self) -> &mut HourTable<H> {
        &mut self.hours
    }

    /// Tracks beyond the capacity.
    #[must_use]
    pub const fn dropped_tracks(&self) -> u32 {
        self.visitors.dropped()
    }

    /// Takes the newest position of a track; the clock on the wall is `offset_s` ahead of UTC.
    pub fn observe(&mut self, person: PersonAt, at: WallTime, offset_s: i32) {
        let geometry = *self.cells.geometry();
        let Self { cells, hours, visitors, rest_us } = self;
        visitors.follow(&geometry, (person, at), |footprint: Footprint| {
            let micros = rest_us.saturating_add(footprint.dwell_us);
            let (dwell_cs, visits) = (micros / HUNDREDTH_US, u16::from(footprint.is_visit));
            *rest_us = micros % HUNDREDTH_US;
            if let Some(cell) = cells.get_mut(footprint.cell) {
                cell.visits = cell.visits.saturating_add(u32::from(visits));
                cell.dwell_cs = cell.dwell_cs.saturating_add(dwell_cs);
            }
            if visits > 0 || dwell_cs > 0 {
                hours.add(footprint.cell, footprint.at.local(offset_s).hour_of_week(), visits, dwell_cs);
            }
        });
    }

    /// The cells for which `is_in_sight` holds were watched for `watched_cs` hundredths of a second.
    pub fn watch(&mut self, watched_cs: u32, mut is_in_sight: impl FnMut(Point2) -> bool) {
        let geometry = *self.cells.geometry();
        for (index, cell) in self.cells.values_mut().iter_mut().enumerate() {
            if is_in_sight(geometry.centre(index)) {
                cell.watched_cs = cell.watched_cs.saturating_add(watched_cs);
            }
        }
    }

    /// Visits and dwell times of every cell in the chosen hours of the week, added to `into`, which holds one value a
    /// cell. `is_chosen` is asked for each hour from Monday 00:00.
    pub fn of_hours(&self, into: &mut [HourCount], is_chosen: impl Fn(u8) -> bool) {
        let mut chosen = [false; HOURS_OF_WEEK];
        chosen.iter_mut().zip(0_u8..).for_each(|(chosen, hour)| *chosen = is_chosen(hour));
        for entry in self.hours.iter() {
            let Some((cell, hour)) = entry.cell_and_hour() else { continue };
            if let (Some(true), Some(value)) = (chosen.get(usize::from(hour)), into.get_mut(cell)) {
                value.visits = value.visits.saturating_add(u32::from(entry.visits));
                value.dwell_cs = value.dwell_cs.saturating_add(entry.dwell_cs);
            }
        }
    }

    /// H(c) = visits / largest visits, within [0, 1]; all zero if nobody came (book, Environment: Heat maps).
    pub fn normalised(&self) -> impl Iterator<Item = f32> {
        let largest = self.cells.values().iter().map(|cell| cell.visits).max().unwrap_or(0).max(1);
        self.cells.values().iter().map(move |cell| nearest_f32(cell.visits) / nearest_f32(largest))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::{vec, vec::Vec};

    type Heat = PeopleHeat<Vec<HeatCell>, Vec<HourEntry>, 8, 64>;

    fn heat() -> Heat {
        let geometry = GridGeometry::new(30, 10, HEAT_CELL_M, Point2::new(0.0, 0.0)).unwrap();
        Heat::new(geometry, vec![HeatCell::default(); 300], vec![HourEntry::NOTHING; 2_048]).unwrap()
    }

    /// Somebody walks along the row at 1 m/s, starting at `hour` of Monday 1970-01-05.
    fn walk(heat: &mut Heat, id: u64, hour: i64) {
        for i in 0..55 {
            let at = WallTime::from_micros((4 * 86_400 + hour * 3_600) * 1_000_000 + i * 100_000);
            let position_in_map = Point2::new(0.05 + i as f32 * 0.1, 1.1);
            heat.observe(PersonAt { id, position_in_map }, at, 0);
        }
    }

    #[test]
    fn counts_trajectories_and_presence_by_the_hour() {
        let mut heat = heat();
        (0..3).for_each(|id| walk(&mut heat, id, 9));
        walk(&mut heat, 9, 15);
        let cell = heat.cells().geometry().cell_at(Point2::new(3.1, 1.1)).unwrap();
        assert_eq!(heat.cells().values()[cell].visits, 4);
        assert!(heat.cells().values().iter().map(|c| c.dwell_cs).sum::<u32>().abs_diff(4 * 540) <= 1);
        let mut nine = vec![HourCount::default(); 300];
        heat.of_hours(&mut nine, |hour| hour == 9);
        assert_eq!(nine[cell].visits, 3);
        let mut tuesday = vec![HourCount::default(); 300];
        heat.of_hours(&mut tuesday, |hour| hour / 24 == 1);
        assert!(tuesday.iter().all(|value| *value == HourCount::default()));
        assert!(heat.normalised().all(|value| (0.0..=1.0).contains(&value)));
        assert!(heat.normalised().any(|value| value == 1.0));
    }

    #[test]
    fn exposure_gives_rates_and_unseen_is_unknown() {
        let mut heat = heat();
        walk(&mut heat, 1, 9);
        heat.watch(360_000, |point| point.x_m < 3.0);
        let at =
            |x_m| *heat.cells().get(heat.cells().geometry().cell_at(Point2::new(x_m, 1.1)).unwrap()).unwrap();
        assert_eq!(at(1.1).visits_per_hour(), Some(1.0));
        assert_eq!(at(5.1).visits_per_hour(), None);
        assert_eq!(at(5.1).people(), None);
        assert!(heat.normalised().count() == 300);
        assert!(self::heat().normalised().all(|value| value == 0.0));
    }
}
