//! The cost of standing somewhere with the true outline (ROS `base_local_planner`, `CostmapModel::footprintCost`).

use floorguard_mapping::GridCoordinates;
use floorguard_types::geometry::{Point2, Pose2};
use floorguard_types::motion::Footprint;
use floorguard_types::number::{truncating_i32, truncating_usize};

use super::view::{CostmapView, Costs};

/// Cells that an edge of an outline may have: an outline of 100 m at 5 cm.
const EDGE_CELLS_MAX: u32 = 2_000;

/// Why a pose cannot be stood at.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FootprintHit {
    /// The outline leaves the costmap.
    Outside,
    /// It touches floor that nobody has looked at.
    Unknown,
    /// It touches an obstacle.
    Obstacle,
}

/// Highest cost under the outline at a pose.
///
/// # Errors
/// See [`FootprintHit`]; unknown floor is a hit.
pub fn footprint_cost(
    costmap: CostmapView<'_>,
    footprint: &Footprint,
    pose_in_map: Pose2,
) -> Result<u8, FootprintHit> {
    let (sin, cos) = libm::sincosf(pose_in_map.heading_rad);
    outline_cost(costmap, footprint, Placement { x_m: pose_in_map.x_m, y_m: pose_in_map.y_m, sin, cos })
}

/// A pose with its sine and cosine at hand.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Placement {
    pub x_m: f32,
    pub y_m: f32,
    pub sin: f32,
    pub cos: f32,
}

impl Placement {
    #[inline]
    fn place(&self, corner: Point2) -> Point2 {
        Point2::new(
            self.x_m + self.cos * corner.x_m - self.sin * corner.y_m,
            self.y_m + self.sin * corner.x_m + self.cos * corner.y_m,
        )
    }
}

pub(crate) fn outline_cost(
    costmap: CostmapView<'_>,
    footprint: &Footprint,
    at: Placement,
) -> Result<u8, FootprintHit> {
    let geometry = costmap.geometry();
    let cell_of = |corner: &Point2| geometry.coordinates_of(at.place(*corner));
    let corners = footprint.corners_in_base();
    let Some(last) = corners.last() else { return Err(FootprintHit::Outside) };
    let mut from = cell_of(last);
    let mut worst = Costs::FREE;
    for corner in corners {
        let to = cell_of(corner);
        worst = worst.max(line_cost(costmap, from, to)?);
        from = to;
    }
    Ok(worst)
}

/// Highest cost along a line of cells (Bresenham 1965).
pub(crate) fn line_cost(
    costmap: CostmapView<'_>,
    from: GridCoordinates,
    to: GridCoordinates,
) -> Result<u8, FootprintHit> {
    let GridCoordinates { mut column, mut row } = from;
    let GridCoordinates { column: last_column, row: last_row } = to;
    let geometry = costmap.geometry();
    let (dx, dy) = (last_column.abs_diff(column), last_row.abs_diff(row));
    // Both ends inside: so is everything between.
    let first = geometry.index(column, row).ok_or(FootprintHit::Outside)?;
    geometry.index(last_column, last_row).ok_or(FootprintHit::Outside)?;
    let steps = dx.max(dy);
    if steps > EDGE_CELLS_MAX {
        return Err(FootprintHit::Outside);
    }
    let (step_x, step_y) = (if last_column > column { 1 } else { -1 }, if last_row > row { 1 } else { -1 });
    let mut error = truncating_i32(steps / 2);
    let mut worst = 0_u8;
    let mut cell = first;
    for _ in 0..=steps.min(EDGE_CELLS_MAX) {
        match costmap.costs().get(cell).copied() {
            Some(Costs::LETHAL) => return Err(FootprintHit::Obstacle),
            Some(Costs::UNKNOWN) | None => return Err(FootprintHit::Unknown),
            Some(cost) => worst = worst.max(cost),
        }
        error = error.wrapping_sub(truncating_i32(dx.min(dy)));
        let is_aside = error < 0;
        if is_aside {
            error = error.wrapping_add(truncating_i32(steps));
        }
        if dx >= dy || is_aside {
            column = column.wrapping_add(step_x);
        }
        if dy > dx || is_aside {
            row = row.wrapping_add(step_y);
        }
        cell = truncating_usize(row).wrapping_mul(geometry.columns()).wrapping_add(truncating_usize(column));
    }
    Ok(worst)
}

#[cfg(test)]
mod tests {
    use super::*;
    use floorguard_mapping::GridGeometry;
    use std::vec;

    fn outline() -> Footprint {
        let corners = [(0.4, 0.2), (-0.4, 0.2), (-0.4, -0.2), (0.4, -0.2)];
        Footprint::new(&corners.map(|(x, y)| Point2::new(x, y))).unwrap()
    }

    #[test]
    fn the_worst_cell_under_the_outline_counts() {
        let geometry = GridGeometry::new(60, 60, 0.05, Point2::default()).unwrap();
        let mut costs = vec![0; 3_600];
        let at = |x_m, y_m| geometry.cell_at(Point2::new(x_m, y_m)).unwrap();
        costs[at(1.5, 1.7)] = 77;
        costs[at(1.5, 1.5)] = Costs::LETHAL;
        costs[at(1.9, 1.9)] = Costs::UNKNOWN;
        costs[at(1.52, 0.8)] = Costs::LETHAL;
        let cost = |x_m, y_m, heading_rad| {
            let view = CostmapView::new(geometry, &costs, 0).unwrap();
            footprint_cost(view, &outline(), Pose2::new(x_m, y_m, heading_rad))
        };
        assert_eq!(cost(1.5, 1.5, 0.0), Ok(77), "what lies inside the outline is not on it");
        assert_eq!(cost(1.5, 0.6, 0.0), Err(FootprintHit::Obstacle));
        assert_eq!(cost(1.5, 1.9, 0.0), Err(FootprintHit::Unknown));
        assert_eq!(cost(0.3, 1.5, 0.0), Err(FootprintHit::Outside));
        assert_eq!(cost(0.3, 1.5, core::f32::consts::FRAC_PI_2), Ok(0));
    }
}
