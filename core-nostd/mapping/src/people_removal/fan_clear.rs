//! How far the rays of a fan are clear: up to what they hit, or to what stands closer beside them than a body's half width.

use floorguard_types::geometry::Point3;
use floorguard_types::number::{saturating_usize, truncating_usize};

use super::fan::{FanCell, SweepFan};

/// How much of a ray counts as clear.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FanRule {
    /// No return lies within this distance beside a clear ray, metres.
    pub tube_m: f32,
    /// A ray is not clear so shortly before its return, metres.
    pub margin_m: f32,
    /// Nor so closely above or below a flat surface that it ends on, metres.
    pub flat_margin_m: f32,
    /// Returns nearer than this are the robot's own, metres; a ray counts from here on.
    pub nearest_m: f32,
    /// Farther than this nothing is claimed: errors of the heading grow with the distance. Metres.
    pub farthest_m: f32,
    /// In each sweep one ray of so many beside each other is cast, in the next sweep its neighbour; at least 1. Which stretches
    /// are clear is decided by all returns.
    pub every: u8,
}

impl Default for FanRule {
    fn default() -> Self {
        Self { tube_m: 0.08, margin_m: 0.15, flat_margin_m: 0.15, nearest_m: 0.4, farthest_m: 12.0, every: 2 }
    }
}

/// The clear stretch of a ray, in the map.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ClearRay {
    /// Nearer end.
    pub from: Point3,
    /// Farther end.
    pub to: Point3,
}

impl<const RINGS: usize, const CELLS: usize> SweepFan<RINGS, CELLS> {
    /// Calls `each` for every ray that is clear somewhere. `limits` is scratch memory, its content does not matter.
    ///
    /// Cost: one pass over the cells, and for every near return the cells within `tube_m` of it.
    pub fn for_each_clear(
        &self,
        rule: FanRule,
        limits: &mut [[f32; CELLS]; RINGS],
        mut each: impl FnMut(ClearRay),
    ) {
        for (ring, row) in limits.iter_mut().enumerate() {
            for (index, limit) in row.iter_mut().enumerate() {
                *limit = self.own_limit_m(ring, index, rule);
            }
        }
        self.block_beside(rule, limits);
        let every = usize::from(rule.every.max(1));
        let turn = truncating_usize(self.turns);
        for (ring, (row, limits)) in self.cells.iter().zip(limits.iter()).enumerate() {
            let first = turn.wrapping_add(ring).checked_rem(every).unwrap_or(0);
            for (cell, limit_m) in row.iter().zip(limits).skip(first).step_by(every) {
                let to_m = limit_m.min(rule.farthest_m);
                if to_m > rule.nearest_m && cell.range_m > 0.0 {
                    each(ClearRay { from: cell.at(rule.nearest_m), to: cell.at(to_m) });
                }
            }
        }
    }

    fn cell(&self, ring: usize, index: usize) -> Option<&FanCell> {
        self.cells.get(ring)?.get(index).filter(|cell| cell.range_m > 0.0)
    }

    /// Up to where a ray is clear by its own return.
    fn own_limit_m(&self, ring: usize, index: usize, rule: FanRule) -> f32 {
        let Some(cell) = self.cell(ring, index) else { return 0.0 };
        let below = ring.checked_sub(1).and_then(|ring| self.cell(ring, index));
        let above = self.cell(ring.saturating_add(1), index);
        let is_flat = [below, above].into_iter().flatten().any(|other| cell.is_flat_towards(other));
        if !is_flat {
            return cell.range_m - rule.margin_m;
        }
        let rise = libm::fabsf(cell.point_in_map.z_m - cell.sensor_in_map.z_m) / cell.range_m.max(0.01);
        cell.range_m - rule.margin_m.max(rule.flat_margin_m / rise.max(0.005))
    }

    /// Every return ends the rays that pass closely beside it.
    fn block_beside(&self, rule: FanRule, limits: &mut [[f32; CELLS]; RINGS]) {
        let step_rad = Self::cell_rad();
        let reach_max = CELLS / 8;
        for (ring, row) in self.cells.iter().enumerate() {
            for (index, cell) in row.iter().enumerate() {
                if cell.range_m <= rule.nearest_m {
                    continue;
                }
                let reach_rad = rule.tube_m / cell.range_m;
                let reach = saturating_usize(reach_rad / step_rad).min(reach_max);
                let until_m = cell.range_m - rule.margin_m;
                for other in ring.saturating_sub(1)..=ring.saturating_add(1).min(RINGS) {
                    let is_near = self.ring_gap_rad(ring, other) < reach_rad;
                    if !is_near || (other == ring && reach == 0) {
                        continue;
                    }
                    let Some(limits) = limits.get_mut(other) else { continue };
                    lower(limits, index, reach, until_m);
                }
            }
        }
    }

    fn ring_gap_rad(&self, ring: usize, other: usize) -> f32 {
        match (self.elevations_rad.get(ring), self.elevations_rad.get(other)) {
            (Some(a), Some(b)) => libm::fabsf(a - b),
            _ => f32::INFINITY,
        }
    }
}

/// More cells than any ring has.
const AROUND_MAX: usize = 65_536;

/// Lowers the limits around a cell of a closed ring.
fn lower(limits: &mut [f32], index: usize, reach: usize, until_m: f32) {
    let cells = limits.len();
    let first = index.saturating_add(cells).saturating_sub(reach);
    for offset in 0..=reach.saturating_mul(2).min(AROUND_MAX) {
        let at = first.saturating_add(offset).checked_rem(cells).unwrap_or(0);
        if let Some(limit) = limits.get_mut(at) {
            *limit = limit.min(until_m);
        }
    }
}

impl FanCell {
    /// The place on the ray at a distance from the sensor.
    fn at(&self, distance_m: f32) -> Point3 {
        let share = distance_m / self.range_m.max(0.01);
        let (from, to) = (self.sensor_in_map, self.point_in_map);
        let between = |from: f32, to: f32| from + share * (to - from);
        Point3::new(between(from.x_m, to.x_m), between(from.y_m, to.y_m), between(from.z_m, to.z_m))
    }

    /// The surface from this return to another one rises by less than half of its length.
    fn is_flat_towards(&self, other: &Self) -> bool {
        let (a, b) = (self.point_in_map, other.point_in_map);
        let (x, y, rise) = (a.x_m - b.x_m, a.y_m - b.y_m, a.z_m - b.z_m);
        4.0 * rise * rise < x * x + y * y
    }
}
