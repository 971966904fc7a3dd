//! The places of a map, 2 m a side, and who comes to them.

use crate::{Grid, GridGeometry, GridTooSmall};
use floorguard_types::geometry::Point2;

use super::place::Place;
use super::visitors::{PersonAt, Visitors};
use super::wall_time::WallTime;

/// Edge of a place, metres (book, Environment: Places).
pub const PLACE_CELL_M: f32 = 2.0;
const TENTH_US: u32 = 100_000;

/// Places in storage `S`.
#[derive(Clone, Debug)]
pub struct Places<S, const HOURS: usize, const PERIODS: usize, const TRACKS: usize, const RECENT: usize> {
    grid: Grid<Place<HOURS, PERIODS>, S>,
    visitors: Visitors<TRACKS, RECENT>,
    /// Time spent that is not yet a tenth of a second.
    rest_us: u32,
}

impl<S, const HOURS: usize, const PERIODS: usize, const TRACKS: usize, const RECENT: usize>
    Places<S, HOURS, PERIODS, TRACKS, RECENT>
where
    S: AsRef<[Place<HOURS, PERIODS>]> + AsMut<[Place<HOURS, PERIODS>]>,
{
    /// Places of which nothing is known.
    ///
    /// # Errors
    /// The storage is too small.
    pub fn new(geometry: GridGeometry, storage: S) -> Result<Self, GridTooSmall> {
        let mut grid = Grid::new(geometry, storage)?;
        grid.values_mut().fill(Place::EMPTY);
        Ok(Self { grid, visitors: Visitors::default(), rest_us: 0 })
    }

    /// All places.
    #[must_use]
    pub const fn grid(&self) -> &Grid<Place<HOURS, PERIODS>, S> {
        &self.grid
    }

    /// All places, to be changed.
    pub const fn grid_mut(&mut self) -> &mut Grid<Place<HOURS, PERIODS>, S> {
        &mut self.grid
    }

    /// Tracks beyond the capacity.
    #[must_use]
    pub const fn dropped_tracks(&self) -> u32 {
        self.visitors.dropped()
    }

    /// Takes the newest position of a track; the clock on the wall is `offset_s` ahead of UTC.
    pub fn observe(&mut self, person: PersonAt, at: WallTime, offset_s: i32) {
        let geometry = *self.grid.geometry();
        let Self { grid, visitors, rest_us } = self;
        visitors.follow(&geometry, (person, at), |footprint| {
            let micros = rest_us.saturating_add(footprint.dwell_us);
            *rest_us = micros % TENTH_US;
            if let Some(place) = grid.get_mut(footprint.cell) {
                place.note((at, offset_s), footprint.is_visit, micros / TENTH_US);
            }
        });
    }

    /// The places for whose centre `is_in_sight` holds were watched for `watched_cs` hundredths of a second that ended
    /// at `at`.
    pub fn watch(
        &mut self,
        (at, offset_s): (WallTime, i32),
        watched_cs: u32,
        mut is_in_sight: impl FnMut(Point2) -> bool,
    ) {
        let geometry = *self.grid.geometry();
        for (index, place) in self.grid.values_mut().iter_mut().enumerate() {
            if is_in_sight(geometry.centre(index)) {
                place.watch((at, offset_s), watched_cs);
            }
        }
    }

    /// Learns every slice that is over.
    pub fn turn_to(&mut self, at: WallTime, offset_s: i32) {
        self.grid.values_mut().iter_mut().for_each(|place| place.turn_to(at, offset_s));
    }

    /// Learns also the slices that are going on, because the watching ends here.
    pub fn close(&mut self, offset_s: i32) {
        self.grid.values_mut().iter_mut().for_each(|place| place.close(offset_s));
    }
}
