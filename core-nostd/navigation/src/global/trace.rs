//! From distances back to a path.

use floorguard_mapping::{GRID_CELLS_MAX, GridCoordinates, GridGeometry};
use floorguard_types::geometry::{Point2, Pose2};
use floorguard_types::motion::{Gear, Waypoint};
use floorguard_types::number::saturating_i32;

use super::contract::PlanFailure;
use super::grid_search::GridSearch;
use crate::costmap::CostmapView;

/// Neighbours: straight ones first.
const NEIGHBOURS: [(i32, i32); 8] = [(1, 0), (-1, 0), (0, 1), (0, -1), (1, 1), (-1, 1), (1, -1), (-1, -1)];

impl<D: AsRef<[u32]> + AsMut<[u32]>, Q: AsRef<[u32]> + AsMut<[u32]>> GridSearch<D, Q> {
    /// The cell before this one on a shortest path from the start; `None` at the start and where nothing was reached.
    #[must_use]
    pub fn previous(&self, costmap: CostmapView<'_>, cell: usize) -> Option<usize> {
        let here = self.distance(cell).filter(|&distance| distance > 0)?;
        let geometry = costmap.geometry();
        let GridCoordinates { column, row } = geometry.coordinates(cell);
        let cost = costmap.costs().get(cell).copied()?;
        let is_open = |x: i32, y: i32| {
            let place = geometry.index(x, y);
            place.is_some_and(|place| {
                let cost = costmap.costs().get(place).copied().unwrap_or(u8::MAX);
                self.steps().straight(cost) > 0 && self.distance(place).is_some()
            })
        };
        for (dx, dy) in NEIGHBOURS {
            let (x, y) = (column.wrapping_add(dx), row.wrapping_add(dy));
            let Some(other) = geometry.index(x, y) else { continue };
            let is_diagonal = dx != 0 && dy != 0;
            let by = if is_diagonal { self.steps().diagonal(cost) } else { self.steps().straight(cost) };
            let fits = self.distance(other).is_some_and(|there| there.saturating_add(by) == here);
            if fits && (!is_diagonal || (is_open(x, row) && is_open(column, y))) {
                return Some(other);
            }
        }
        None
    }

    /// Writes the path from the start to a cell, one waypoint a cell, each heading to the next one.
    pub(super) fn trace(
        &self,
        costmap: CostmapView<'_>,
        goal: usize,
        path: &mut [Waypoint],
    ) -> Result<usize, PlanFailure> {
        let geometry = costmap.geometry();
        let steps_max = geometry.cell_count();
        let (mut cell, mut count) = (goal, 0_usize);
        for _ in 0..steps_max.min(GRID_CELLS_MAX) {
            let centre = geometry.centre(cell);
            if let Some(slot) = path.get_mut(count) {
                *slot = Waypoint { pose_in_map: Pose2::new(centre.x_m, centre.y_m, 0.0), gear: Gear::Ahead };
            }
            count = count.saturating_add(1);
            let Some(previous) = self.previous(costmap, cell) else { break };
            cell = previous;
        }
        if self.distance(cell) != Some(0) {
            return Err(PlanFailure::Unreachable);
        }
        let written = path.get_mut(..count).ok_or(PlanFailure::PathTooLong(count))?;
        turn_round(written);
        head_forward(written);
        Ok(count)
    }
}

fn turn_round(path: &mut [Waypoint]) {
    let half = path.len() / 2;
    let (front, back) = path.split_at_mut_checked(half).unwrap_or_default();
    for (first, last) in front.iter_mut().zip(back.iter_mut().rev()) {
        core::mem::swap(first, last);
    }
}

/// Every waypoint heads to the next one, the last one as the one before.
pub(super) fn head_forward(path: &mut [Waypoint]) {
    let mut heading_rad = 0.0;
    let count = path.len();
    for at in 0..count {
        let here = path.get(at).map(Waypoint::place_in_map);
        let next = path.get(at.saturating_add(1)).map(Waypoint::place_in_map);
        if let (Some(here), Some(next)) = (here, next) {
            heading_rad = libm::atan2f(next.y_m - here.y_m, next.x_m - here.x_m);
        }
        if let Some(waypoint) = path.get_mut(at) {
            waypoint.pose_in_map.heading_rad = heading_rad;
        }
    }
}

/// The nearest cell to a point, at most `reach_m` from it, for which `is_good` holds; ties go to the smaller index.
pub(crate) fn nearest_cell(
    geometry: &GridGeometry,
    point_in_map: Point2,
    reach_m: f32,
    is_good: impl Fn(usize) -> bool,
) -> Option<usize> {
    let own = geometry.cell_at(point_in_map)?;
    if is_good(own) {
        return Some(own);
    }
    let reach = saturating_i32(reach_m.max(0.0) * geometry.cells_per_metre()).min(100);
    let GridCoordinates { column, row } = geometry.coordinates(own);
    let mut best: Option<(i32, usize)> = None;
    for dy in reach.wrapping_neg()..=reach {
        for dx in reach.wrapping_neg()..=reach {
            let squared = dx.wrapping_mul(dx).wrapping_add(dy.wrapping_mul(dy));
            let Some(cell) = geometry.index(column.wrapping_add(dx), row.wrapping_add(dy)) else { continue };
            let is_nearer = best.is_none_or(|(nearest, _)| squared < nearest);
            if squared <= reach.wrapping_mul(reach) && is_nearer && is_good(cell) {
                best = Some((squared, cell));
            }
        }
    }
    best.map(|(_, cell)| cell)
}
