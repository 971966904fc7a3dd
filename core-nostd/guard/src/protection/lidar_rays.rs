//! What a scan and a lidar packet say to the memory: what they met, and what they looked through.
//!
//! First the looks, then what was met, so that an object thinner than a cell stays although rays pass beside
//! it.

use super::config::{LidarGeometry, ScannerGeometry};
use super::local_memory::{CELL_M, Cell, LocalMemory};
use super::packet_table::{BIN_CDEG, PacketTable};
use super::scan_table::ScanTable;
use floorguard_types::capacities::PACKET_RINGS_MAX;
use floorguard_types::geometry::{Point2, Point3, Pose2};
use floorguard_types::number::saturating_usize;
use floorguard_types::sensing::{BeamReturn, LidarColumn, LidarPacket, Scan};
use floorguard_types::units::centidegrees_to_radians;

/// Farther away nothing is kept: the window ends there, metres from the sensor.
const REACH_M: f32 = 3.2;
/// A look passes through a cell when it ends this far behind its middle, metres: half a cell's diagonal and the noise of a range.
const BEHIND_M: f32 = 0.10;
/// Neighbouring rays that end so near to each other met the same object, metres; a single one is noise.
const SAME_OBSTACLE_M: f32 = 0.15;
/// Of each packet one firing is taken, this many after the one of the packet before: so that all directions get their turn.
const FIRING_STEP: usize = 7;
/// Every so-many-th beam of a scan is compared with its neighbour: a cell in 3 m has five.
const BEAM_STEP: usize = 2;
/// Cells with something in them that one firing looks through.
const LOOKED_THROUGH_MAX: u8 = 8;
/// The lidar itself sees nothing nearer, metres in the plane.
const NEAREST_M: f32 = 0.35;
/// Cells along a ray.
const STEPS: u16 = ((REACH_M - NEAREST_M) / CELL_M) as u16;
/// Returns this low are compared with the ring above: what rises gently is a ramp, metres.
const RAMP_BELOW_M: f32 = 0.16;
/// Slopes between which it is one.
const RAMP: core::ops::Range<f32> = 0.02..0.2;
/// The memory keeps what stands at least this far below the lidar, metres: only what lies below it sinks under its rays when the
/// robot comes near, and all of that is looked through again by rays that end on the floor.
const BELOW_LIDAR_M: f32 = 0.05;
/// Share of the floor clearance above which the memory takes a return for an object: it must see lower objects than the
/// field, because it sees them from farther away.
const CLEARANCE_SHARE: f32 = 0.75;

/// The rays of the lidar in the robot frame.
#[derive(Clone, Debug, PartialEq)]
pub struct LidarRays {
    pub(crate) origin: Point3,
    pub(crate) rotation: [[f32; 3]; 3],
    /// Cosine and sine of the elevation of each ring.
    pub(crate) rings: [[f32; 2]; PACKET_RINGS_MAX],
    pub(crate) count: usize,
    /// Between these heights the memory keeps what was met, metres: in the way of the body, and below the lidar.
    pub(crate) heights_m: [f32; 2],
}

impl LidarRays {
    /// No ray.
    pub const NONE: Self = Self {
        origin: Point3::new(0.0, 0.0, 0.0),
        rotation: [[0.0; 3]; 3],
        rings: [[0.0; 2]; PACKET_RINGS_MAX],
        count: 0,
        heights_m: [0.0; 2],
    };

    /// Precomputes them, in place.
    pub fn fill(&mut self, geometry: &LidarGeometry) {
        self.origin = geometry.mounting.translation;
        self.rotation = geometry.mounting.rotation;
        self.count = geometry.elevations_rad.len();
        let top_m = geometry.body_height_m.min(self.origin.z_m - BELOW_LIDAR_M);
        self.heights_m = [CLEARANCE_SHARE * geometry.floor_clearance_m, top_m];
        for (ring, elevation_rad) in self.rings.iter_mut().zip(&geometry.elevations_rad) {
            let (sin, cos) = libm::sincosf(*elevation_rad);
            *ring = [cos, sin];
        }
    }

    /// Every number, for the sum.
    pub(super) fn words(&self) -> impl Iterator<Item = f32> + '_ {
        let place = [self.origin.x_m, self.origin.y_m, self.origin.z_m];
        let rings = self.rings.iter().flatten().copied();
        place
            .into_iter()
            .chain(self.rotation.as_flattened().iter().copied())
            .chain(rings)
            .chain(self.heights_m)
    }
}

/// One firing, seen from above, in the frame of the memory.
struct Firing {
    origin: Point2,
    height_m: f32,
    /// What a metre of the range is in the plane and upwards, per ring.
    rays: [Ray; PACKET_RINGS_MAX],
}

#[derive(Clone, Copy, Default)]
struct Ray {
    x: f32,
    y: f32,
    plane: f32,
    /// Height gained per metre in the plane.
    slope: f32,
}

impl LidarRays {
    fn firing(&self, azimuth_cdeg: u16, pose: Pose2) -> Firing {
        let (sin_heading, cos_heading) = libm::sincosf(pose.heading_rad);
        let (sin, cos) = libm::sincosf(-centidegrees_to_radians(azimuth_cdeg));
        let [rx, ry, rz] = &self.rotation;
        let level = |row: &[f32; 3]| row[0] * cos + row[1] * sin;
        let (ax, ay, az) = (level(rx), level(ry), level(rz));
        let turned = |x: f32, y: f32| (cos_heading * x - sin_heading * y, sin_heading * x + cos_heading * y);
        let (ox, oy) = turned(self.origin.x_m, self.origin.y_m);
        let (wx, wy) = turned(ax, ay);
        let (ux, uy) = turned(rx[2], ry[2]);
        let mut rays = [Ray::default(); PACKET_RINGS_MAX];
        for (ray, [ring_cos, ring_sin]) in rays.iter_mut().zip(&self.rings).take(self.count) {
            let (x, y) = (ring_cos * wx + ring_sin * ux, ring_cos * wy + ring_sin * uy);
            let plane = libm::sqrtf(x * x + y * y).max(1.0e-3);
            let slope = (ring_cos * az + ring_sin * rz[2]) / plane;
            *ray = Ray { x, y, plane, slope };
        }
        Firing { origin: Point2::new(pose.x_m + ox, pose.y_m + oy), height_m: self.origin.z_m, rays }
    }
}

impl LocalMemory {
    /// Takes in one firing of a lidar packet.
    pub fn take_packet(&mut self, packet: &LidarPacket, (rays, table): (&LidarRays, &PacketTable)) {
        self.turn = self.turn.wrapping_add(FIRING_STEP);
        let index = self.turn.checked_rem(packet.columns.len()).unwrap_or(0);
        let beside = if index == 0 { 1 } else { index.wrapping_sub(1) };
        let (Some(column), Some(neighbour)) = (packet.columns.get(index), packet.columns.get(beside)) else {
            return;
        };
        let pose = self.pose_at(packet.stamp);
        let unit_m = f32::from(packet.range_unit_mm) * 1.0e-3;
        let firing = rays.firing(column.azimuth_cdeg, pose);
        let reaches_m = reaches_m(&firing, column, (unit_m, rays.count));
        self.look_along(&firing, &reaches_m);
        let bin = table.bins.get(usize::from(column.azimuth_cdeg / BIN_CDEG));
        let own_m = bin.map_or(0.0, |bin| f32::from(bin.own_mm) * 1.0e-3);
        self.meet_along(&firing, (column, neighbour), (unit_m, own_m, rays.heights_m));
    }

    /// What one firing met.
    fn meet_along(
        &mut self,
        firing: &Firing,
        (column, neighbour): (&LidarColumn, &LidarColumn),
        (unit_m, own_m, [low_m, high_m]): (f32, f32, [f32; 2]),
    ) {
        let returns = column.range_raw.iter().zip(&neighbour.range_raw).zip(&firing.rays);
        for (ring, ((raw, beside), ray)) in returns.enumerate() {
            let range_m = f32::from(*raw) * unit_m;
            let plane_m = range_m * ray.plane;
            let is_one_thing = (range_m - f32::from(*beside) * unit_m).abs() < SAME_OBSTACLE_M;
            if *raw == 0 || plane_m > REACH_M || plane_m < own_m || !is_one_thing {
                continue;
            }
            let height_m = firing.height_m + plane_m * ray.slope;
            if height_m < low_m || height_m > high_m {
                continue;
            }
            if height_m < RAMP_BELOW_M && is_ramp(firing, column, (ring, plane_m, height_m), unit_m) {
                continue;
            }
            let cell = Cell::of(Point2::new(
                firing.origin.x_m + range_m * ray.x,
                firing.origin.y_m + range_m * ray.y,
            ));
            // At the middle of the cell, as a look through it is: so that the same ray has the same height.
            let middle_m = cell.middle().distance(firing.origin);
            let at_middle_m = firing.height_m + middle_m * ray.slope;
            let gap_m = middle_m * RING_GAP + CELL_M * ray.slope.abs();
            self.meet(cell, at_middle_m, gap_m);
        }
    }

    /// Cells through which one firing looks: from near, and the next time from afar, because their number is limited.
    fn look_along(&mut self, firing: &Firing, reaches_m: &[f32; PACKET_RINGS_MAX]) {
        let Some(level) = firing.rays.first() else { return };
        let (x, y) = (level.x / level.plane.max(1.0e-3), level.y / level.plane.max(1.0e-3));
        let farthest_m = reaches_m.iter().copied().fold(0.0, f32::max) - BEHIND_M;
        let mut last = Cell { x: i32::MAX, y: i32::MAX };
        let mut left = LOOKED_THROUGH_MAX;
        let is_from_afar = self.turn & 1 != 0;
        for step in 0..STEPS {
            let step = if is_from_afar { (STEPS - 1).saturating_sub(step) } else { step };
            let path_m = NEAREST_M + f32::from(step) * CELL_M;
            let cell = Cell::of(Point2::new(firing.origin.x_m + path_m * x, firing.origin.y_m + path_m * y));
            if path_m > farthest_m || cell == last || !self.holds(cell) {
                continue;
            }
            last = cell;
            left = left.saturating_sub(1);
            if left == 0 {
                break;
            }
            let middle_m = cell.middle().distance(firing.origin);
            for (reach_m, ray) in reaches_m.iter().zip(&firing.rays) {
                if *reach_m > middle_m + BEHIND_M {
                    self.pass(cell, firing.height_m + middle_m * ray.slope);
                }
            }
        }
    }

    /// Takes in a scan of the safety scanner that fits the table.
    pub fn take_scan(&mut self, scan: &Scan, table: &ScanTable) {
        let pose = self.pose_at(scan.stamp);
        let (sin, cos) = libm::sincosf(pose.heading_rad);
        let geometry = &table.geometry;
        let mounted = pose.transform(Point2::new(geometry.mounting.x_m, geometry.mounting.y_m));
        let heading_rad = pose.heading_rad + geometry.mounting.heading_rad;
        self.look_through_plane(scan, geometry, (mounted, heading_rad));
        let [first, last] = beams_of_sector(geometry);
        let offset = first.wrapping_add(self.turn % BEAM_STEP);
        let beams = scan.beams.iter().zip(scan.beams.iter().skip(1)).zip(&table.directions).enumerate();
        for (index, ((beam, beside), direction)) in beams.skip(offset).step_by(BEAM_STEP) {
            if index >= last {
                break;
            }
            let (BeamReturn::Hit(range_mm), BeamReturn::Hit(beside_mm)) = (*beam, *beside) else { continue };
            let range_m = f32::from(range_mm) * 1.0e-3;
            // Two beams make an object.
            if range_m > REACH_M || (f32::from(beside_mm) * 1.0e-3 - range_m).abs() > SAME_OBSTACLE_M {
                continue;
            }
            let (x, y) =
                (cos * direction.x_m - sin * direction.y_m, sin * direction.x_m + cos * direction.y_m);
            self.set_scanned(
                Cell::of(Point2::new(mounted.x_m + range_m * x, mounted.y_m + range_m * y)),
                true,
            );
        }
    }

    /// Clears the scanned cells that a beam has passed through.
    fn look_through_plane(
        &mut self,
        scan: &Scan,
        geometry: &ScannerGeometry,
        (at, heading_rad): (Point2, f32),
    ) {
        let [first, last] = beams_of_sector(geometry);
        let per_rad = 1.0 / geometry.step_rad;
        let mut seen_through = heapless::Vec::<Cell, SEEN_THROUGH_MAX>::new();
        self.for_each(true, |cell| {
            let middle = cell.middle();
            let (dx, dy) = (middle.x_m - at.x_m, middle.y_m - at.y_m);
            let bearing_rad = floorguard_types::geometry::wrap_angle(libm::atan2f(dy, dx) - heading_rad);
            let beam = libm::roundf((bearing_rad - geometry.first_angle_rad) * per_rad);
            if beam < first as f32 || beam > last as f32 {
                return;
            }
            let free_m = match scan.beams.get(saturating_usize(beam)) {
                Some(BeamReturn::Hit(range_mm) | BeamReturn::Free(range_mm)) => f32::from(*range_mm) * 1.0e-3,
                _ => 0.0,
            };
            if free_m > Point2::new(dx, dy).norm() + BEHIND_M {
                // Full: the next scan clears the rest.
                let _ = seen_through.push(cell);
            }
        });
        for cell in &seen_through {
            self.set_scanned(*cell, false);
        }
    }
}

/// How far the rays of a firing went, metres in the plane: without a return nobody knows, and nothing was looked through.
fn reaches_m(
    firing: &Firing,
    column: &LidarColumn,
    (unit_m, count): (f32, usize),
) -> [f32; PACKET_RINGS_MAX] {
    let mut reaches_m = [0.0; PACKET_RINGS_MAX];
    let rays = column.range_raw.iter().zip(&firing.rays).take(count);
    for (reach_m, (raw, ray)) in reaches_m.iter_mut().zip(rays) {
        *reach_m = f32::from(*raw) * unit_m * ray.plane;
    }
    reaches_m
}

/// Cells that one scan clears at most.
const SEEN_THROUGH_MAX: usize = 256;
/// Rings of a VLP-16 are 2° apart: metres between two rays, with a half more, per metre.
const RING_GAP: f32 = 0.052;

/// Indices of the first and last beam that the robot's own body does not cover.
fn beams_of_sector(geometry: &ScannerGeometry) -> [usize; 2] {
    let index = |angle_rad: f32| (angle_rad - geometry.first_angle_rad) / geometry.step_rad;
    let [first_rad, last_rad] = geometry.sector_rad;
    [
        saturating_usize(libm::ceilf(index(first_rad) - 0.5)),
        saturating_usize(libm::floorf(index(last_rad) + 0.5)),
    ]
}

/// The ring above ends behind this return and a little higher, as on a ramp.
fn is_ramp(
    firing: &Firing,
    column: &LidarColumn,
    (ring, plane_m, height_m): (usize, f32, f32),
    unit_m: f32,
) -> bool {
    let above = ring.saturating_add(1);
    let (Some(raw), Some(ray)) = (column.range_raw.get(above), firing.rays.get(above)) else { return false };
    if *raw == 0 {
        return false;
    }
    let next_m = f32::from(*raw) * unit_m * ray.plane;
    let rise_m = firing.height_m + next_m * ray.slope - height_m;
    let run_m = next_m - plane_m;
    run_m > 0.0 && rise_m > RAMP.start * run_m && rise_m < RAMP.end * run_m
}
