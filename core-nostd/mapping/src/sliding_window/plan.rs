//! Memory around the robot, seen from above: heights on the floor, and what hangs from the ceiling.
//!
//! Two horizontal grids in the map's frame (Dalmedico et al. 2019): what is not higher than a threshold stands on
//! the floor, and the highest counts; the rest hangs from the ceiling, and the lowest counts. Before cells of the window
//! enter, the floor is cleared where the sight polygon shows it free. Places of people block until they expire.

use floorguard_types::geometry::{Point2, Pose2};
use floorguard_types::number::{saturating_i16, saturating_i32};
use floorguard_types::time::Stamp;

use super::cell::{CellContent, PERSON_EXPIRY_US, WindowCell};
use super::clearing::SweptWedge;
use super::compensation::{Rigid, is_finite};
use super::sight::{SightLimits, SightPolygon};
use super::window::{SlidingWindow, WindowPoint};
use crate::{Grid, GridCoordinates, GridGeometry, GridShift, GridTooSmall};

/// Edge of a cell, metres (Dalmedico et al. 2019).
pub const PLAN_RESOLUTION_M: f32 = 0.2;
/// The window reaches this far at most, metres: a corner of a lateral grid.
const REACH_M: f32 = 5.2;
/// Cells to each side that clearing visits, as a bound: 5.2 m in cells of 1 cm.
const REACH_CELLS_MAX: i32 = 520;
const UNKNOWN: i16 = i16::MIN;
const TICK_US: u64 = 100_000;
const MILLIMETRES: f32 = 1.0e3;
const METRES: f32 = 1.0e-3;

/// A cell of the plan.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct PlanCell {
    floor_mm: i16,
    ceiling_mm: i16,
    /// Tenths of a second from the start of the clock, rounded up; 0 for no person.
    person_until: u32,
}

impl PlanCell {
    /// Nothing was seen.
    pub const UNKNOWN: Self = Self { floor_mm: UNKNOWN, ceiling_mm: UNKNOWN, person_until: 0 };

    /// Height of what stands on the floor, metres: 0 is floor that was seen free; `None` where nothing was seen.
    #[must_use]
    pub fn floor_m(&self) -> Option<f32> {
        (self.floor_mm != UNKNOWN).then(|| f32::from(self.floor_mm) * METRES)
    }

    /// Height of the lowest surface above the threshold, metres.
    #[must_use]
    pub fn ceiling_m(&self) -> Option<f32> {
        (self.ceiling_mm != UNKNOWN).then(|| f32::from(self.ceiling_mm) * METRES)
    }

    /// A person stood here less than two seconds ago.
    #[must_use]
    pub fn is_person(&self, now: Stamp) -> bool {
        u64::from(self.person_until).saturating_mul(TICK_US) > now.as_micros()
    }
}

/// What entering a window changed.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct PlanChange {
    /// Floor cells that the sight polygon cleared.
    pub cleared: u32,
    /// Window cells that entered as obstacles on the floor.
    pub obstacles: u32,
    /// Window cells outside of the plan.
    pub outside: u32,
}

/// Floor and ceiling around the robot, over storage that is handed in.
///
/// ```
/// use floorguard_mapping::sliding_window::{Plan, PlanCell};
/// use floorguard_types::geometry::Point2;
///
/// // 20 m by 20 m in cells of 0.2 m.
/// let plan = Plan::square(100, Point2::new(0.0, 0.0), vec![PlanCell::UNKNOWN; 10_000]).unwrap()?;
/// assert_eq!(plan.grid().get(5_050).unwrap().floor_m(), None);
/// # Ok::<(), floorguard_mapping::GridTooSmall>(())
/// ```
#[derive(Clone, Debug)]
pub struct Plan<S> {
    grid: Grid<PlanCell, S>,
}

impl<S: AsRef<[PlanCell]> + AsMut<[PlanCell]>> Plan<S> {
    /// A plan over cells of a geometry; what the storage holds becomes its content.
    ///
    /// # Errors
    /// The storage is too small.
    pub fn new(geometry: GridGeometry, storage: S) -> Result<Self, GridTooSmall> {
        Ok(Self { grid: Grid::new(geometry, storage)? })
    }

    /// A square plan of so many cells of 0.2 m along each side around a centre; `None` for no cell or a centre that is not
    /// finite.
    pub fn square(side: u16, centre_in_map: Point2, storage: S) -> Option<Result<Self, GridTooSmall>> {
        let half_m = 0.5 * f32::from(side) * PLAN_RESOLUTION_M;
        let corner = Point2::new(centre_in_map.x_m - half_m, centre_in_map.y_m - half_m);
        let geometry = GridGeometry::new(side, side, PLAN_RESOLUTION_M, corner)?;
        Some(Self::new(geometry, storage))
    }

    /// The cells. Index 0 has the smallest coordinates; x runs first.
    #[must_use]
    pub const fn grid(&self) -> &Grid<PlanCell, S> {
        &self.grid
    }

    /// Moves the plan by whole cells so that a place of the map lies in its middle; what comes in is unknown.
    pub fn recentre(&mut self, centre_in_map: Point2) -> GridShift {
        self.grid.recentre(centre_in_map, PlanCell::UNKNOWN)
    }

    /// Enters the window: clears what the sight polygon shows free within the directions that were swept, then enters its
    /// cells. `window_in_map` is where the window's frame stands in the map; a pose that is not finite changes nothing.
    /// Without a blocking cell there is no polygon, and nothing is cleared. Cost: two passes over the window, and one over
    /// the cells within 5.2 m.
    pub fn enter<W: AsRef<[WindowCell]> + AsMut<[WindowCell]>>(
        &mut self,
        (window, window_in_map): (&SlidingWindow<W>, Pose2),
        swept: SweptWedge,
        (limits, now): (&SightLimits, Stamp),
    ) -> PlanChange {
        let mut change = PlanChange::default();
        if !is_finite(window_in_map) {
            return change;
        }
        let polygon = SightPolygon::of(window, limits);
        change.cleared = self.clear_seen(&polygon, window_in_map, swept);
        let map_from_window = Rigid::of(window_in_map);
        // Floor first: what stands in the same cell must stay. Floor below what is too low for the robot is not free.
        let is_floor = |one: &WindowPoint| one.point.z_m < limits.floor_max_m;
        let is_open = |one: &WindowPoint| !polygon.is_behind(Point2::new(one.point.x_m, one.point.y_m));
        for one in window.points().filter(is_floor).filter(is_open) {
            let is_now = swept.contains(libm::atan2f(one.point.y_m, one.point.x_m));
            if let Some(cell) = self.cell_of(map_from_window, &one)
                && one.content == CellContent::Surface
                && (is_now || cell.floor_mm == UNKNOWN)
            {
                cell.floor_mm = 0;
            }
        }
        for one in window.points().filter(|one| !is_floor(one)) {
            let Some(cell) = self.cell_of(map_from_window, &one) else {
                change.outside = change.outside.saturating_add(1);
                continue;
            };
            change.obstacles = change.obstacles.saturating_add(u32::from(cell.take(&one, limits, now)));
        }
        change
    }

    fn cell_of(&mut self, map_from_window: Rigid, one: &WindowPoint) -> Option<&mut PlanCell> {
        let point = map_from_window.transform(one.point);
        let index = self.grid.geometry().cell_at(Point2::new(point.x_m, point.y_m))?;
        self.grid.get_mut(index)
    }

    fn clear_seen(&mut self, polygon: &SightPolygon, window_in_map: Pose2, swept: SweptWedge) -> u32 {
        let geometry = *self.grid.geometry();
        let window_from_map = Rigid::of(window_in_map.inverse());
        let centre = geometry.coordinates_of(Point2::new(window_in_map.x_m, window_in_map.y_m));
        let reach = saturating_i32(REACH_M * geometry.cells_per_metre()).clamp(0, REACH_CELLS_MAX);
        let mut cleared = 0_u32;
        for row in -reach..=reach {
            for column in -reach..=reach {
                let place = GridCoordinates {
                    column: centre.column.saturating_add(column),
                    row: centre.row.saturating_add(row),
                };
                let Some(index) = geometry.index(place.column, place.row) else { continue };
                let middle = geometry.centre(index);
                let seen = window_from_map.transform_flat(middle);
                let is_free = swept.contains(libm::atan2f(seen.y_m, seen.x_m)) && polygon.contains(seen);
                if is_free && let Some(cell) = self.grid.get_mut(index) {
                    cell.floor_mm = 0;
                    cleared = cleared.saturating_add(1);
                }
            }
        }
        cleared
    }
}

impl PlanCell {
    /// Enters a cell of the window that is higher than the floor. True where it is an obstacle on the floor.
    fn take(&mut self, one: &WindowPoint, limits: &SightLimits, now: Stamp) -> bool {
        if one.content == CellContent::Person {
            let ends_us = now.plus_micros(PERSON_EXPIRY_US).as_micros();
            // 2³² tenths of a second are 13 years.
            self.person_until = u32::try_from(ends_us.div_ceil(TICK_US)).unwrap_or(u32::MAX);
            return false;
        }
        let height_mm = saturating_i16(libm::roundf(one.point.z_m * MILLIMETRES));
        let is_on_floor = one.point.z_m <= limits.threshold_m;
        if is_on_floor {
            self.floor_mm = self.floor_mm.max(height_mm);
        } else if self.ceiling_mm == UNKNOWN || height_mm < self.ceiling_mm {
            self.ceiling_mm = height_mm;
        }
        is_on_floor
    }
}

#[cfg(test)]
#[path = "plan_tests.rs"]
mod tests;
