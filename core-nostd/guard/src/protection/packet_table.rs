//! What a lidar ray must not end in, computed once.
//!
//! Per bin of azimuth: how far the fields and the robot's own body reach in the plane. Per bin and ring: the plane's
//! share of a range, and the range at which the ray meets the floor or rises above the robot.

use super::config::{FieldSet, LidarGeometry};
use super::field::ray_exit_m;
use floorguard_types::capacities::{FIELD_SETS_MAX, PACKET_RINGS_MAX};
use floorguard_types::geometry::{Point2, Point3};
use floorguard_types::number::saturating_u16;
use floorguard_types::units::centidegrees_to_radians;

/// Bins of azimuth.
pub(crate) const BINS: usize = 180;
/// Width of a bin, hundredths of a degree.
pub(crate) const BIN_CDEG: u16 = 200;
/// A bin takes the extreme of this many rays across it.
const SAMPLES: u16 = 5;
/// How the rays of a bin relate to the robot.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Bin {
    /// In the plane of the floor, robot frame.
    pub(crate) direction: Point2,
    /// Share of the range that lies in the plane, 1/65,536.
    pub(crate) plane_share: [u16; PACKET_RINGS_MAX],
    /// The least of them.
    pub(crate) least_share: u16,
    /// Returns beyond are floor, or pass over the robot, millimetres.
    pub(crate) height_mm: [u16; PACKET_RINGS_MAX],
    /// Returns nearer, in the plane, come from the robot itself, millimetres.
    pub(crate) own_mm: u16,
    /// Reach of the protective fields in the plane, millimetres.
    pub(crate) protective_mm: [u16; FIELD_SETS_MAX],
}

/// Precomputed limits.
#[derive(Clone, Debug, PartialEq)]
pub struct PacketTable {
    pub(crate) bins: [Bin; BINS],
    pub(crate) origin: Point2,
}

impl PacketTable {
    /// No ray is known.
    pub const EMPTY: Self = Self { bins: [Bin::EMPTY; BINS], origin: Point2::new(0.0, 0.0) };

    /// Precomputes the limits, in place.
    pub fn fill(&mut self, geometry: &LidarGeometry, sets: &[FieldSet]) {
        let translation = geometry.mounting.translation;
        self.origin = Point2::new(translation.x_m, translation.y_m);
        let mut first_cdeg = 0_u16;
        for bin in &mut self.bins {
            *bin = Bin { least_share: u16::MAX, own_mm: u16::MAX, ..Bin::EMPTY };
            for sample in 0..SAMPLES {
                let step_cdeg = BIN_CDEG / (SAMPLES - 1);
                let azimuth_cdeg = first_cdeg.saturating_add(sample.saturating_mul(step_cdeg));
                bin.widen(geometry, sets, azimuth_cdeg);
            }
            first_cdeg = first_cdeg.saturating_add(BIN_CDEG);
        }
    }
}

impl Bin {
    /// Nothing but zeros, which take no space in a program.
    const EMPTY: Self = Self {
        direction: Point2::new(0.0, 0.0),
        plane_share: [0; PACKET_RINGS_MAX],
        least_share: 0,
        height_mm: [0; PACKET_RINGS_MAX],
        own_mm: 0,
        protective_mm: [0; FIELD_SETS_MAX],
    };

    /// Takes one ray into account: the field as large, the own body as small, as any ray of the bin has it.
    fn widen(&mut self, geometry: &LidarGeometry, sets: &[FieldSet], azimuth_cdeg: u16) {
        let azimuth_rad = -centidegrees_to_radians(azimuth_cdeg);
        let origin = geometry.mounting.translation;
        let origin_in_plane = Point2::new(origin.x_m, origin.y_m);
        for ((share, height_mm), elevation_rad) in
            self.plane_share.iter_mut().zip(&mut self.height_mm).zip(&geometry.elevations_rad)
        {
            let ray = ray_in_robot(geometry, azimuth_rad, *elevation_rad);
            let in_plane = Point2::new(ray.x_m, ray.y_m).norm();
            // The middle ray comes last of those that matter; casts saturate at the greatest number.
            *share = saturating_u16(in_plane * 65_535.0);
            let limit_m = if ray.z_m < 0.0 {
                (origin.z_m - geometry.floor_clearance_m) / -ray.z_m
            } else {
                (geometry.body_height_m - origin.z_m).max(0.0) / ray.z_m.max(1.0e-6)
            };
            *height_mm = (*height_mm).max(saturating_u16(limit_m * 1.0e3));
        }
        let rings = geometry.elevations_rad.len();
        self.least_share = self.plane_share.iter().take(rings).copied().min().unwrap_or(0);
        let level = ray_in_robot(geometry, azimuth_rad, 0.0);
        let norm = Point2::new(level.x_m, level.y_m).norm().max(1.0e-6);
        self.direction = Point2::new(level.x_m / norm, level.y_m / norm);
        let own_m = ray_exit_m(&geometry.self_mask, origin_in_plane, self.direction);
        self.own_mm = self.own_mm.min(saturating_u16(own_m * 1.0e3));
        for (reach_mm, set) in self.protective_mm.iter_mut().zip(sets) {
            let reach_m = ray_exit_m(&set.protective, origin_in_plane, self.direction);
            *reach_mm = (*reach_mm).max(saturating_u16(libm::ceilf(reach_m * 1.0e3)));
        }
    }
}

/// Unit vector of a ray, turned into the robot frame.
fn ray_in_robot(geometry: &LidarGeometry, azimuth_rad: f32, elevation_rad: f32) -> Point3 {
    let (sin_azimuth, cos_azimuth) = libm::sincosf(azimuth_rad);
    let (sin_elevation, cos_elevation) = libm::sincosf(elevation_rad);
    let in_sensor = Point3::new(cos_elevation * cos_azimuth, cos_elevation * sin_azimuth, sin_elevation);
    let tip = geometry.mounting.transform(in_sensor);
    let origin = geometry.mounting.translation;
    Point3::new(tip.x_m - origin.x_m, tip.y_m - origin.y_m, tip.z_m - origin.z_m)
}
