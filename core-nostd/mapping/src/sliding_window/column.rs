//! The scan before the newest one: what it saw through, and in which direction.

use floorguard_types::geometry::{Point2, Point3, Pose2, wrap_angle};
use floorguard_types::number::{nearest_f32, saturating_u16, saturating_usize};
use floorguard_types::sensing::BeamReturn;
use floorguard_types::time::Stamp;
use heapless::Vec;

use super::capacities::WINDOW_BEAMS_MAX;
use super::lidar::{ColumnScan, LidarMount, ScanAngles};

const MILLIMETRES: f32 = 1.0e3;

/// The returns of a scan, and where it looked. Invariant: without beams it sees through nothing.
#[derive(Clone, Debug)]
pub(super) struct Column {
    pub(super) stamp: Stamp,
    pub(super) first_elevation_rad: f32,
    step_rad: f32,
    pub(super) beams_per_rad: f32,
    /// Part of the scan from beam to beam.
    pub(super) part_of_beam: f32,
    /// Directions of the first and the last beam in odometry, radians.
    first_rad: f32,
    last_rad: f32,
    /// The axis in odometry.
    axis: Pose2,
    pub(super) beams: Vec<BeamReturn, WINDOW_BEAMS_MAX>,
}

/// A point as the lidar sees it from its axis.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Seen {
    /// From the axis over the floor, metres.
    pub(super) distance_m: f32,
    elevation_rad: f32,
    range_m: f32,
}

impl Column {
    /// No scan.
    pub(super) const NONE: Self = Self {
        stamp: Stamp::ZERO,
        first_elevation_rad: 0.0,
        step_rad: 1.0,
        beams_per_rad: 1.0,
        part_of_beam: 1.0,
        first_rad: 0.0,
        last_rad: 0.0,
        axis: Pose2 { x_m: 0.0, y_m: 0.0, heading_rad: 0.0 },
        beams: Vec::new(),
    };

    pub(super) fn is_none(&self) -> bool {
        self.beams.is_empty()
    }

    /// Becomes a scan from a pose of the base in odometry.
    pub(super) fn take(
        &mut self,
        scan: &ColumnScan<'_>,
        mount: &LidarMount,
        (angles, base_in_odometry): (ScanAngles, Pose2),
    ) {
        self.stamp = scan.first_beam;
        self.first_elevation_rad = scan.first_elevation_rad;
        self.step_rad = scan.step_rad;
        // A scan was checked: its step is positive.
        self.beams_per_rad = 1.0 / scan.step_rad;
        self.part_of_beam = 1.0 / nearest_f32(scan.beams.len().saturating_sub(1)).max(1.0);
        self.axis = base_in_odometry.compose(Pose2::new(mount.axis_x_m, mount.axis_y_m, 0.0));
        self.first_rad = self.axis.heading_rad + angles.first_rad;
        self.last_rad = self.axis.heading_rad + angles.last_rad;
        self.beams.clear();
        // The scan was checked: it has at most as many beams.
        let _too_many = self.beams.extend_from_slice(scan.beams);
    }

    /// Direction of the middle of the scan in odometry, radians, not wrapped.
    pub(super) fn middle_rad(&self) -> f32 {
        0.5 * (self.first_rad + self.last_rad)
    }

    /// The axis in odometry.
    pub(super) const fn axis(&self) -> Point2 {
        Point2::new(self.axis.x_m, self.axis.y_m)
    }

    /// Direction of the first beam in odometry, radians.
    pub(super) const fn first_rad(&self) -> f32 {
        self.first_rad
    }

    /// Direction of the last beam in odometry, radians.
    pub(super) const fn last_rad(&self) -> f32 {
        self.last_rad
    }

    /// How far the scan is slanted, radians.
    pub(super) fn slant_rad(&self) -> f32 {
        libm::fabsf(self.last_rad - self.first_rad)
    }

    /// A point in odometry as this scan's lidar sees it. Its height is above the floor.
    pub(super) fn see(&self, point: Point3, mount: &LidarMount) -> Seen {
        let (x, y) = (point.x_m - self.axis.x_m, point.y_m - self.axis.y_m);
        let distance_m = libm::sqrtf(x * x + y * y);
        let (ahead, up) = (distance_m - mount.lever_arm_m, point.z_m - mount.height_m);
        Seen {
            distance_m,
            elevation_rad: libm::atan2f(up, ahead),
            range_m: libm::sqrtf(ahead * ahead + up * up),
        }
    }

    /// Direction of the beam of a point relative to the point's own direction, radians, left positive.
    pub(super) fn beside_rad(&self, seen: &Seen, point: Point3) -> f32 {
        let azimuth_rad = libm::atan2f(point.y_m - self.axis.y_m, point.x_m - self.axis.x_m);
        let last = nearest_f32(self.beams.len().saturating_sub(1)).max(1.0);
        let part = (self.beam_of(seen) / last).clamp(0.0, 1.0);
        wrap_angle(self.first_rad + part * (self.last_rad - self.first_rad) - azimuth_rad)
    }

    fn beam_of(&self, seen: &Seen) -> f32 {
        // A scan was checked: its step is positive.
        (seen.elevation_rad - self.first_elevation_rad) / self.step_rad
    }

    /// The beam at the elevation of a point and its two neighbours all end behind the point by a margin. What was not
    /// measured is not seen through.
    pub(super) fn sees_through(&self, seen: &Seen, margin_m: f32) -> bool {
        let nearest = libm::roundf(self.beam_of(seen));
        let has_neighbours = nearest >= 1.0 && nearest < nearest_f32(self.beams.len()) - 1.0;
        if !has_neighbours {
            return false;
        }
        let limit_mm = saturating_u16((seen.range_m + margin_m) * MILLIMETRES);
        let first = saturating_usize(nearest).saturating_sub(1);
        let around = self.beams.get(first..first.saturating_add(3));
        around.is_some_and(|beams| beams.iter().all(|beam| beam.is_behind(limit_mm, 0)))
    }
}
