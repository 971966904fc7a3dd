//! A path down the gradient of a potential, in steps of half a cell (ROS `navfn`, `calcPath`).

use floorguard_mapping::{GRID_CELLS_MAX, GridCoordinates, GridGeometry};
use floorguard_types::geometry::{Point2, Pose2};
use floorguard_types::motion::{Gear, Waypoint};

use super::contract::PlanFailure;
use super::potential::UNREACHED;
use super::trace::head_forward;

/// Length of a step, cells.
const STEP_CELLS: f32 = 0.5;
/// A step that lowers the potential by less than this is none.
const LEAST_FALL: f32 = 1.0e-3;

/// Writes a path from `from_in_map` down to the cell of potential 0. Where the gradient does not lead down (beside obstacles it
/// can turn in circles) the step goes to the lowest neighbour, as published. Gives how many waypoints were written.
///
/// # Errors
/// [`PlanFailure::Unreachable`] where no wave has been, [`PlanFailure::PathTooLong`] where `path` is too small.
pub fn descend(
    geometry: &GridGeometry,
    potentials: &[f32],
    from_in_map: Point2,
    path: &mut [Waypoint],
) -> Result<usize, PlanFailure> {
    let slope = Slope { geometry, potentials };
    let mut here = from_in_map;
    let steps_max = geometry.cell_count().saturating_mul(4);
    let mut count = 0_usize;
    for _ in 0..steps_max.min(GRID_CELLS_MAX) {
        let cell = geometry.cell_at(here).ok_or(PlanFailure::Unreachable)?;
        let value = slope.at(cell);
        if value >= UNREACHED {
            return Err(PlanFailure::Unreachable);
        }
        let slot = path.get_mut(count).ok_or(PlanFailure::PathTooLong(count.saturating_add(1)))?;
        *slot = Waypoint { pose_in_map: Pose2::new(here.x_m, here.y_m, 0.0), gear: Gear::Ahead };
        count = count.saturating_add(1);
        if value <= 0.0 {
            head_forward(path.get_mut(..count).unwrap_or(&mut []));
            return Ok(count);
        }
        here = slope.step(here, cell).ok_or(PlanFailure::Unreachable)?;
    }
    Err(PlanFailure::Unreachable)
}

struct Slope<'a> {
    geometry: &'a GridGeometry,
    potentials: &'a [f32],
}

impl Slope<'_> {
    fn at(&self, cell: usize) -> f32 {
        self.potentials.get(cell).copied().unwrap_or(UNREACHED)
    }

    fn neighbour(&self, cell: usize, dx: i32, dy: i32) -> Option<usize> {
        let GridCoordinates { column, row } = self.geometry.coordinates(cell);
        self.geometry.index(column.wrapping_add(dx), row.wrapping_add(dy))
    }

    /// Half a cell down the gradient, or to the centre of the lowest neighbour.
    fn step(&self, here: Point2, cell: usize) -> Option<Point2> {
        if let Some(next) = self.gradient_step(here, cell) {
            let lower = self.geometry.cell_at(next).map_or(UNREACHED, |next| self.at(next));
            let is_other = self.geometry.cell_at(next) != Some(cell);
            if lower < self.at(cell) - LEAST_FALL || (!is_other && self.is_towards_lower(here, next, cell)) {
                return Some(next);
            }
        }
        let lowest = self.lowest_neighbour(cell)?;
        Some(self.geometry.centre(lowest))
    }

    /// A step within the cell counts where it approaches the lowest neighbour.
    fn is_towards_lower(&self, here: Point2, next: Point2, cell: usize) -> bool {
        self.lowest_neighbour(cell).is_some_and(|lowest| {
            let centre = self.geometry.centre(lowest);
            let gain_m = here.distance(centre) - next.distance(centre);
            gain_m > 0.2 * STEP_CELLS * self.geometry.resolution_m()
        })
    }

    fn lowest_neighbour(&self, cell: usize) -> Option<usize> {
        let mut best: Option<(f32, usize)> = None;
        for (dx, dy) in [(1, 0), (-1, 0), (0, 1), (0, -1), (1, 1), (-1, 1), (1, -1), (-1, -1)] {
            let Some(other) = self.neighbour(cell, dx, dy) else { continue };
            let is_open = |dx, dy| self.neighbour(cell, dx, dy).is_some_and(|side| self.at(side) < UNREACHED);
            let value = self.at(other);
            let is_lower = value < self.at(cell) && best.is_none_or(|(lowest, _)| value < lowest);
            if is_lower && (dx == 0 || dy == 0 || (is_open(dx, 0) && is_open(0, dy))) {
                best = Some((value, other));
            }
        }
        best.map(|(_, other)| other)
    }

    fn gradient_step(&self, here: Point2, cell: usize) -> Option<Point2> {
        let fall = |low: Option<usize>, high: Option<usize>| {
            let (low, high) = (self.at(low?), self.at(high?));
            (low < UNREACHED && high < UNREACHED).then_some(low - high)
        };
        let dx = fall(self.neighbour(cell, -1, 0), self.neighbour(cell, 1, 0))?;
        let dy = fall(self.neighbour(cell, 0, -1), self.neighbour(cell, 0, 1))?;
        let length = Point2::new(dx, dy).norm();
        if length < LEAST_FALL {
            return None;
        }
        let step_m = STEP_CELLS * self.geometry.resolution_m();
        Some(Point2::new(here.x_m + step_m * dx / length, here.y_m + step_m * dy / length))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::costmap::{CostmapView, Costs};
    use crate::global::{PublishedDijkstra, StepCosts, Wavefront};
    use std::vec;

    /// Round the end of a wall, and little longer than the two straight pieces.
    #[test]
    fn descends_round_a_wall() {
        let geometry = GridGeometry::new(61, 41, 0.05, Point2::default()).unwrap();
        let mut costs = vec![0_u8; geometry.cell_count()];
        for row in 0..30 {
            costs[row * 61 + 30] = Costs::LETHAL;
        }
        let view = CostmapView::new(geometry, &costs, 0).unwrap();
        let (mut values, mut pending) = (vec![0.0; costs.len()], vec![false; costs.len()]);
        let (mut a, mut b, mut c) = (vec![0; 999], vec![0; 999], vec![0; 999]);
        let wave = Wavefront {
            potentials: &mut values,
            is_pending: &mut pending,
            buffers: [&mut a, &mut b, &mut c],
        };
        let steps = StepCosts::new(false);
        let mut planner = PublishedDijkstra::new(wave, &steps);
        let start = geometry.index(10, 10).unwrap();
        assert_eq!(planner.run(view, start, None), Ok(false));
        let mut path = vec![Waypoint::default(); 999];
        let from = geometry.centre(geometry.index(50, 10).unwrap());
        let count = descend(&geometry, planner.potentials(), from, &mut path).unwrap();
        let length: f32 =
            path[..count].windows(2).map(|p| p[0].place_in_map().distance(p[1].place_in_map())).sum();
        let corner = geometry.centre(geometry.index(30, 30).unwrap());
        let least = corner.distance(from) + corner.distance(geometry.centre(start));
        assert!(length > least - 0.1 && length < 1.08 * least, "{length} m for {least} m");
        for at in &path[..count] {
            assert!(view.cost_at(at.place_in_map()) < Costs::INSCRIBED);
        }
        assert_eq!(
            descend(&geometry, planner.potentials(), from, &mut path[..5]),
            Err(PlanFailure::PathTooLong(6))
        );
        let walled = geometry.centre(geometry.index(30, 5).unwrap());
        assert_eq!(
            descend(&geometry, planner.potentials(), walled, &mut path),
            Err(PlanFailure::Unreachable)
        );
    }
}
