//! What a lidar packet says to the memory: what it met, and what it looked through.
//!
//! First the looks, then what was met, so that an object thinner than a cell stays although rays pass beside
//! it.

use super::config::Thresholds;
use super::lidar_rays::{Firing, LidarRays};
use super::local_memory::{CELL_M, Cell, LocalMemory};
use super::packet_table::{BIN_CDEG, PacketTable};
use floorguard_types::capacities::PACKET_RINGS_MAX;
use floorguard_types::geometry::Point2;
use floorguard_types::number::saturating_i32;
use floorguard_types::sensing::{LidarColumn, LidarPacket};

/// No look is followed farther: the window ends there, metres from the sensor.
const REACH_M: f32 = 3.2;
/// A look passes through a cell when it ends this far behind its middle, metres: half a cell's diagonal and the noise of a range.
pub(super) const BEHIND_M: f32 = 0.10;
/// Neighbouring rays that end so near to each other met the same object, metres; a single one is noise.
pub(super) const SAME_OBSTACLE_M: f32 = 0.15;
/// Of each packet one firing is taken, this many after the one of the packet before: so that all directions get their turn.
const FIRING_STEP: usize = 7;
/// Firings of a packet that are taken in at most: all that a VLP-16 sends in one.
const FIRINGS_MAX: u8 = 24;
/// Cells with something in them that one firing looks through.
const LOOKED_THROUGH_MAX: u8 = 4;
/// The lidar itself sees nothing nearer, metres in the plane.
const NEAREST_M: f32 = 0.35;
/// Cells along a ray.
const STEPS: i32 = saturating_i32((REACH_M - NEAREST_M) / CELL_M);
/// Returns this low are compared with the ring above: what rises gently is a ramp, metres.
const RAMP_BELOW_M: f32 = 0.16;
/// What ends below this is no person, metres: the highest return of one within a cell is a knee at least.
const LOW_M: f32 = 0.25;
/// Slopes between which it is one.
const RAMP: core::ops::Range<f32> = 0.02..0.2;
/// A ramp begins on the floor: where the way up to a return is steeper by this than the way on from it, a step leads up to it, as to the
/// side of a ramp.
const STEP_MORE: f32 = 0.03;
/// What rises more steeply is an obstacle, and up to this slope it is a surface that begins on the floor before the return.
const STEEP: f32 = 0.6;
/// Rings of a VLP-16 are 2° apart: metres between two rays, with a half more, per metre.
const RING_GAP: f32 = 0.052;
/// Returns nearer to each other than this have no slope, metres.
const LEAST_RUN_M: f32 = 1.0e-3;
/// So low over the floor the lowest ring has seen what lies there, metres.
const OVER_FLOOR_M: f32 = 0.08;
/// What ends lower ends on the floor, metres.
const ON_FLOOR_M: f32 = 0.03;
/// Cells along it there: a ring that sinks by a quarter of its way.
const FLOOR_STEPS: u8 = 8;
/// Parts of a cell in which its places are counted along a look.
const PARTS_OF_CELL: f32 = 65_536.0;

/// One firing beside the next one: a return that both have is an object.
struct Pair<'a> {
    column: &'a LidarColumn,
    beside: &'a LidarColumn,
    unit_m: f32,
    /// Returns nearer come from the robot itself, metres in the plane.
    own_m: f32,
}

impl LocalMemory {
    /// Takes in one firing of a lidar packet: at most 40 cells of its look, and its returns up to `reach_m` from the lidar, metres
    /// in the plane.
    pub fn take_packet(&mut self, packet: &LidarPacket, rays: (&LidarRays, &PacketTable), reach_m: f32) {
        self.take_firing(packet, rays, (reach_m, false));
    }

    fn take_firing(
        &mut self,
        packet: &LidarPacket,
        (rays, table): (&LidarRays, &PacketTable),
        (reach_m, marks_floor): (f32, bool),
    ) {
        self.turn = self.turn.wrapping_add(FIRING_STEP);
        let index = self.turn.checked_rem(packet.columns.len()).unwrap_or(0);
        let beside = if index == 0 { 1 } else { index.wrapping_sub(1) };
        let (Some(column), Some(beside)) = (packet.columns.get(index), packet.columns.get(beside)) else {
            return;
        };
        let Some(bin) = table.bins.get(usize::from(column.azimuth_cdeg / BIN_CDEG)) else { return };
        let unit_m = f32::from(packet.range_unit_mm) * 1.0e-3;
        let firing = rays.firing(column.azimuth_cdeg, bin, self.pose_at(packet.stamp));
        let reaches_m = firing.reaches_m(column, unit_m);
        self.look_along((&firing, rays), &reaches_m);
        if marks_floor {
            self.look_at_floor(&firing, &reaches_m);
        }
        let pair = Pair { column, beside, unit_m, own_m: f32::from(bin.own_mm) * 1.0e-3 };
        self.meet_along(&firing, &pair, (rays.heights_m, reach_m));
    }

    /// Takes in more firings of the same packet, as many as the thresholds say (FG-REQ-066), and the floor that they see.
    pub fn take_more(
        &mut self,
        packet: &LidarPacket,
        rays: (&LidarRays, &PacketTable),
        thresholds: &Thresholds,
    ) {
        for _ in 1..thresholds.memory_firings.min(FIRINGS_MAX) {
            self.take_firing(packet, rays, (thresholds.memory_reach_m, true));
        }
    }

    /// What one firing met.
    fn meet_along(&mut self, firing: &Firing, pair: &Pair<'_>, ([low_m, high_m], reach_m): ([f32; 2], f32)) {
        let returns = pair.column.range_raw.iter().zip(&pair.beside.range_raw).zip(&firing.rays);
        for (ring, ((raw, beside), ray)) in returns.enumerate() {
            let range_m = f32::from(*raw) * pair.unit_m;
            let plane_m = range_m * ray.plane;
            let height_m = firing.height_m + plane_m * ray.slope;
            let is_one_thing = (range_m - f32::from(*beside) * pair.unit_m).abs() < SAME_OBSTACLE_M;
            if *raw == 0 || plane_m > reach_m || plane_m < pair.own_m || !is_one_thing {
                continue;
            }
            if height_m < low_m || height_m > high_m {
                continue;
            }
            let mut toe_m = None;
            if height_m < RAMP_BELOW_M
                && let Some(slope) = slope_to(firing, pair, (ring.saturating_add(1), plane_m, height_m))
            {
                let below = ring.checked_sub(1);
                let below = below.and_then(|below| slope_to(firing, pair, (below, plane_m, height_m)));
                let has_step = below.is_some_and(|below| below > slope + STEP_MORE);
                if RAMP.contains(&slope) && !has_step {
                    continue;
                }
                let begins_on_floor = below.is_some() && !has_step;
                let is_steep = (RAMP.end..STEEP).contains(&slope) && begins_on_floor;
                toe_m = is_steep.then(|| plane_m - height_m / slope);
            }
            if let Some(toe_m) = toe_m.filter(|toe_m| *toe_m > pair.own_m.max(NEAREST_M)) {
                self.meet(firing.cell_at(toe_m), 0.0, 0.0);
            }
            let cell = Cell::of(Point2::new(
                firing.origin.x_m + range_m * ray.x,
                firing.origin.y_m + range_m * ray.y,
            ));
            // At the middle of the cell, as a look through it is: so that the same ray has the same height.
            let middle_m = firing.along_m(cell.middle());
            let gap_m = middle_m * RING_GAP + CELL_M * ray.slope.abs();
            self.meet(cell, firing.height_m + middle_m * ray.slope, gap_m);
        }
    }

    /// Cells through which one firing looks: from near, and the next time from afar, because their number is limited.
    fn look_along(&mut self, (firing, rays): (&Firing, &LidarRays), reaches_m: &[f32; PACKET_RINGS_MAX]) {
        let farthest_m = reaches_m.iter().copied().fold(0.0, f32::max) - BEHIND_M;
        let looked = saturating_i32((farthest_m - NEAREST_M) * (1.0 / CELL_M)).saturating_add(1).min(STEPS);
        // In parts of a cell, counted from the corner of the window: a step is as long as a cell.
        let (along_x, along_y) = (parts(firing.direction.x_m), parts(firing.direction.y_m));
        let nearest = Point2::new(
            firing.origin.x_m + NEAREST_M * firing.direction.x_m,
            firing.origin.y_m + NEAREST_M * firing.direction.y_m,
        );
        let from = self.in_window(nearest);
        let (from_x, from_y) = (parts(from.x_m), parts(from.y_m));
        let mut last = Cell { x: i32::MAX, y: i32::MAX };
        let mut left = LOOKED_THROUGH_MAX;
        let is_from_afar = self.turn & 1 != 0;
        for step in 0..STEPS {
            if step >= looked || left == 0 {
                break;
            }
            let step = if is_from_afar { looked.wrapping_sub(1).wrapping_sub(step) } else { step };
            let x = from_x.wrapping_add(step.wrapping_mul(along_x)) >> 16;
            let y = from_y.wrapping_add(step.wrapping_mul(along_y)) >> 16;
            let cell = self.cell_in_window(x, y);
            if cell == last || !self.holds(cell) {
                continue;
            }
            (last, left) = (cell, left.saturating_sub(1));
            self.look_through(cell, (firing, rays), reaches_m);
        }
    }

    /// Cells over which the lowest ring has passed so low that it would have met nearly all that the memory keeps.
    fn look_at_floor(&mut self, firing: &Firing, reaches_m: &[f32; PACKET_RINGS_MAX]) {
        let ([ray, ..], [reach_m, ..]) = (&firing.rays, reaches_m);
        let from_m = (firing.height_m - OVER_FLOOR_M) / (-ray.slope).max(1.0e-3);
        // Where it ends on an object, that begins a little before.
        let ends_on_floor = firing.height_m + reach_m * ray.slope < ON_FLOOR_M;
        let mut at_m = reach_m.min(REACH_M) - if ends_on_floor { 0.0 } else { BEHIND_M };
        for _ in 0..FLOOR_STEPS {
            if at_m < from_m {
                break;
            }
            if let Some((row, index)) = self.place(firing.cell_at(at_m)) {
                row.set_floor(index);
            }
            at_m -= CELL_M;
        }
    }

    /// The rays of a firing that go through a cell refute what was met in it at their heights.
    fn look_through(
        &mut self,
        cell: Cell,
        (firing, lidar): (&Firing, &LidarRays),
        reaches_m: &[f32; PACKET_RINGS_MAX],
    ) {
        let middle_m = firing.along_m(cell.middle());
        let run = self.run(cell);
        let refutes = |(reach_m, slope): (&f32, f32)| {
            *reach_m > middle_m + BEHIND_M && run.is_refuted_at_m(firing.height_m + middle_m * slope)
        };
        let is_refuted = reaches_m.iter().zip(firing.rays.iter().map(|ray| ray.slope)).any(refutes);
        // Past the end of something low rays pass beside what others meet; who walks away is higher.
        let is_low_end = run.ends_below_m(LOW_M) && self.is_fresh(cell);
        if is_refuted && !is_low_end && !self.stays_edge(cell, lidar) {
            self.clear_lidar(cell);
        }
    }
}

/// A number of cells in parts of a cell.
pub(super) fn parts(cells: f32) -> i32 {
    saturating_i32(libm::floorf(cells * PARTS_OF_CELL))
}

/// How steeply it rises from a return to the one of another ring of the firing, or from that one to it; none without such a return.
fn slope_to(firing: &Firing, pair: &Pair<'_>, (ring, plane_m, height_m): (usize, f32, f32)) -> Option<f32> {
    let (raw, ray) = (pair.column.range_raw.get(ring)?, firing.rays.get(ring)?);
    if *raw == 0 {
        return None;
    }
    let other_m = f32::from(*raw) * pair.unit_m * ray.plane;
    let rise_m = firing.height_m + other_m * ray.slope - height_m;
    let run_m = other_m - plane_m;
    (run_m.abs() > LEAST_RUN_M).then(|| rise_m / run_m)
}
