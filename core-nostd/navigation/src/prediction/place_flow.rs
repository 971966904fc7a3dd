//! How people go on from a place, by the direction in which they come.

use floorguard_mapping::{GridGeometry, GridTooSmall};
use floorguard_types::geometry::Point2;
use floorguard_types::number::{nearest_f32, saturating_i32, truncating_i32, truncating_usize};

/// Directions that are kept apart.
pub const FLOW_HEADINGS: usize = 8;
/// Slower people have no direction, metres a step.
const STANDING_M: f32 = 0.15;
/// Visits after which a place counts half as much as the person's own velocity.
const TRUSTED_VISITS: f32 = 3.0;
/// Visits that are remembered: later ones replace earlier ones.
const VISITS_MAX: f32 = 200.0;
/// How much of the place's velocity a person takes over in a step.
const PULL: f32 = 0.15;

/// What is known of one place and direction.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct FlowCell {
    visits: f32,
    next_x_m: f32,
    next_y_m: f32,
}

/// Mean next steps, [`FLOW_HEADINGS`] cells a cell of the raster, in storage `S`.
#[derive(Clone, Debug)]
pub struct PlaceFlow<S> {
    geometry: GridGeometry,
    cells: S,
}

impl<S: AsRef<[FlowCell]> + AsMut<[FlowCell]>> PlaceFlow<S> {
    /// Over a raster; cells of 0.75 m are a good size. What the storage holds is what is known.
    ///
    /// # Errors
    /// The storage is too small.
    pub fn new(geometry: GridGeometry, cells: S) -> Result<Self, GridTooSmall> {
        let (needed, capacity) = (geometry.cell_count().saturating_mul(FLOW_HEADINGS), cells.as_ref().len());
        if capacity < needed {
            return Err(GridTooSmall { needed, capacity });
        }
        Ok(Self { geometry, cells })
    }

    fn index(&self, place: Point2, step: Point2) -> Option<usize> {
        if step.norm().is_nan() || step.norm() < STANDING_M {
            return None;
        }
        let cell = self.geometry.cell_at(place)?;
        let turn = libm::atan2f(step.y_m, step.x_m) / core::f32::consts::TAU;
        let heading = saturating_i32(libm::floorf(turn * nearest_f32(FLOW_HEADINGS) + 0.5));
        let heading = truncating_usize(heading.rem_euclid(truncating_i32(FLOW_HEADINGS)));
        Some(cell.saturating_mul(FLOW_HEADINGS).saturating_add(heading))
    }

    /// Somebody came to a place with one step and went on with the next.
    pub fn learn(&mut self, place: Point2, step: Point2, next: Point2) {
        let index = self.index(place, step).filter(|_| next.norm().is_finite());
        let Some(cell) = index.and_then(|index| self.cells.as_mut().get_mut(index)) else { return };
        cell.visits = (cell.visits + 1.0).min(VISITS_MAX);
        cell.next_x_m += (next.x_m - cell.next_x_m) / cell.visits;
        cell.next_y_m += (next.y_m - cell.next_y_m) / cell.visits;
    }

    /// The next step of somebody who came to a place with this one: a little towards how others went on, at a speed between
    /// theirs and the person's own.
    #[must_use]
    pub fn bend(&self, place: Point2, step: Point2) -> Point2 {
        let known = self.index(place, step).and_then(|index| self.cells.as_ref().get(index));
        let Some(cell) = known.filter(|cell| cell.visits > 0.0) else { return step };
        let share = PULL * cell.visits / (cell.visits + TRUSTED_VISITS);
        let others = Point2::new(cell.next_x_m, cell.next_y_m);
        let scale =
            if others.norm() > 0.01 { 0.5 * (step.norm() + others.norm()) / others.norm() } else { 1.0 };
        Point2::new(
            step.x_m + share * (others.x_m * scale - step.x_m),
            step.y_m + share * (others.y_m * scale - step.y_m),
        )
    }
}
