//! The rays of the lidar in the robot frame, and one firing of them in the frame of the memory.

use super::config::LidarGeometry;
use super::local_memory::Cell;
use super::packet_table::Bin;
use floorguard_types::capacities::PACKET_RINGS_MAX;
use floorguard_types::geometry::{Point2, Point3, Pose2};
use floorguard_types::sensing::LidarColumn;
use floorguard_types::units::centidegrees_to_radians;

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
    /// Height that the lowest ring gains for each metre straight ahead of the lidar.
    pub(crate) lowest_slope: f32,
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
        lowest_slope: 0.0,
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
        let [rx, ry, rz] = &self.rotation;
        let ahead = |row: &[f32; 3], [cos, sin]: &[f32; 2]| cos * row[0] + sin * row[2];
        let slope = |ring: &[f32; 2]| {
            ahead(rz, ring) / Point2::new(ahead(rx, ring), ahead(ry, ring)).norm().max(1.0e-3)
        };
        self.lowest_slope = self.rings.iter().take(self.count).map(slope).fold(0.0, f32::min);
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
            .chain([self.lowest_slope])
    }

    /// The rays of one firing. `bin` is the one of its azimuth: it knows the plane's share of each ray.
    pub(super) fn firing(&self, azimuth_cdeg: u16, bin: &Bin, pose: Pose2) -> Firing {
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
        let known = self.rings.iter().zip(&bin.plane_share).take(self.count);
        for (ray, ([ring_cos, ring_sin], share)) in rays.iter_mut().zip(known) {
            let plane = (f32::from(*share) * (1.0 / 65_535.0)).max(1.0e-3);
            let slope = (ring_cos * az + ring_sin * rz[2]) / plane;
            *ray = Ray { x: ring_cos * wx + ring_sin * ux, y: ring_cos * wy + ring_sin * uy, plane, slope };
        }
        let [first, ..] = &rays;
        let per_metre = 1.0 / first.plane.max(1.0e-3);
        Firing {
            origin: Point2::new(pose.x_m + ox, pose.y_m + oy),
            direction: Point2::new(first.x * per_metre, first.y * per_metre),
            height_m: self.origin.z_m,
            rays,
        }
    }
}

/// One firing, seen from above, in the frame of the memory.
pub(super) struct Firing {
    pub(super) origin: Point2,
    /// Where its rays go, in the plane.
    pub(super) direction: Point2,
    pub(super) height_m: f32,
    /// What a metre of the range is in the plane and upwards, per ring.
    pub(super) rays: [Ray; PACKET_RINGS_MAX],
}

#[derive(Clone, Copy, Default)]
pub(super) struct Ray {
    pub(super) x: f32,
    pub(super) y: f32,
    pub(super) plane: f32,
    /// Height gained per metre in the plane.
    pub(super) slope: f32,
}

impl Firing {
    /// How far along the firing a place lies, metres in the plane.
    pub(super) fn along_m(&self, place: Point2) -> f32 {
        self.direction.x_m * (place.x_m - self.origin.x_m)
            + self.direction.y_m * (place.y_m - self.origin.y_m)
    }

    /// The cell that lies so far along it, metres in the plane.
    pub(super) fn cell_at(&self, along_m: f32) -> Cell {
        Cell::of(Point2::new(
            self.origin.x_m + along_m * self.direction.x_m,
            self.origin.y_m + along_m * self.direction.y_m,
        ))
    }

    /// How far its rays went, metres in the plane: without a return nothing is known, and nothing was looked through.
    pub(super) fn reaches_m(&self, column: &LidarColumn, unit_m: f32) -> [f32; PACKET_RINGS_MAX] {
        let mut reaches_m = [0.0; PACKET_RINGS_MAX];
        for (reach_m, (raw, ray)) in reaches_m.iter_mut().zip(column.range_raw.iter().zip(&self.rays)) {
            *reach_m = f32::from(*raw) * unit_m * ray.plane;
        }
        reaches_m
    }
}
