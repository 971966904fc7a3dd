//! What the space held a moment ago, as the lidar saw it then: free, the same surface, hidden, or unknown.
//!
//! A static thing that comes out from behind another fills voxels that were empty before, just like one that moves. The
//! range image of the moment before tells them apart: only where the lidar looked through, something has come.

use crate::capacities::{SWEEP_COLUMNS, SWEEP_RINGS};
use crate::geometry::{Point3, Pose2, Transform3, Twist2};
use crate::people::{RingAngles, SweepContext};
use crate::sensing::Sweep;

/// Sectors of 0.4°: two columns of a revolution.
const SECTORS: usize = 900;
const SECTOR_CDEG: u32 = 40;
/// No beam went there.
const UNMEASURED: u16 = 0;
/// Beams went there and none came back.
const NO_RETURN: u16 = u16::MAX;
/// Ranges that differ by less are the same surface, metres: noise of both and half a beam at a grazing angle.
const SAME_M: f32 = 0.2;
/// What stood in front is gone if the lidar now looks through by more than this, metres: noise of both.
const GONE_M: f32 = 0.1;
/// What stood nearer by at most this may be the thing itself, which has receded since, metres: a person and a stride.
const RECEDED_M: f32 = 0.8;

/// What was where a point is now.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Before {
    /// The lidar looked through.
    Free,
    /// Hidden behind a surface not far in front, here in the frame of the odometry: if that is gone now, it was the
    /// thing itself, which has receded since.
    JustBehind(Point3),
    /// The same surface.
    Same,
    /// Hidden behind something else.
    Hidden,
    /// Not measured, no beam came back, or nearer and farther surfaces side by side.
    Unknown,
}

/// Where the lidar must look to see a point.
#[derive(Clone, Copy, Debug, Default)]
struct Direction {
    /// Azimuth, hundredths of a degree.
    cdeg: u32,
    range_m: f32,
    /// Above the lidar, metres.
    up_m: f32,
    /// The lidar, in the frame of the odometry.
    sensor: Point3,
}

/// The returns in the directions around a point.
#[derive(Clone, Copy, Debug, Default)]
struct Around {
    /// How far the point lies behind the farthest and the nearest of them, metres.
    behind_m: Option<(f32, f32)>,
    same: bool,
    unmeasured: bool,
}

impl Around {
    fn note(&mut self, behind_m: f32, same_m: f32) {
        self.same |= behind_m.abs() <= same_m;
        let (least_m, most_m) = self.behind_m.unwrap_or((behind_m, behind_m));
        self.behind_m = Some((least_m.min(behind_m), most_m.max(behind_m)));
    }

    /// One surface that agrees settles it; otherwise all must tell the same.
    fn verdict(&self, point: Point3, seen: &Direction) -> Before {
        match self.behind_m {
            _ if self.same => Before::Same,
            Some((_, most_m)) if most_m < -SAME_M && !self.unmeasured => Before::Free,
            Some((least_m, _)) if least_m > RECEDED_M => Before::Hidden,
            Some((least_m, _)) if least_m > SAME_M => Before::JustBehind(towards(point, seen, least_m)),
            _ => Before::Unknown,
        }
    }
}

/// Nearest return per direction of one sweep, and where the lidar stood. 28 KiB.
#[derive(Clone, Debug)]
pub(super) struct SeenThrough {
    /// Counts of `metres_per_count`.
    nearest: [[u16; SWEEP_RINGS]; SECTORS],
    metres_per_count: f32,
    first_azimuth_cdeg: u16,
    duration_s: f32,
    base_in_odom: Pose2,
    sensor_in_base: Transform3,
    twist: Twist2,
}

impl SeenThrough {
    pub(super) const fn new() -> Self {
        Self {
            nearest: [[UNMEASURED; SWEEP_RINGS]; SECTORS],
            metres_per_count: 0.002,
            first_azimuth_cdeg: 0,
            duration_s: 0.0,
            base_in_odom: Pose2 { x_m: 0.0, y_m: 0.0, heading_rad: 0.0 },
            sensor_in_base: Transform3::IDENTITY,
            twist: Twist2::ZERO,
        }
    }

    /// Takes a sweep as the moment before.
    pub(super) fn take(&mut self, sweep: &Sweep, context: &SweepContext) {
        self.nearest.fill([UNMEASURED; SWEEP_RINGS]);
        self.metres_per_count = f32::from(sweep.range_unit_mm) * 1.0e-3;
        self.first_azimuth_cdeg = sweep.used_columns().first().map_or(0, |column| column.azimuth_cdeg);
        self.duration_s = sweep.end_stamp.seconds_since(sweep.stamp);
        self.base_in_odom = context.base_in_odom;
        self.sensor_in_base = context.sensor_in_base;
        self.twist = context.twist;
        for column in sweep.used_columns().iter().take(SWEEP_COLUMNS).filter(|column| column.measured) {
            let Some(nearest) = self.nearest.get_mut(sector(u32::from(column.azimuth_cdeg))) else {
                continue;
            };
            for (nearest, raw) in nearest.iter_mut().zip(&column.range_raw) {
                let range = if *raw == 0 { NO_RETURN } else { *raw };
                *nearest = if *nearest == UNMEASURED { range } else { range.min(*nearest) };
            }
        }
    }

    /// What was at a point of the frame of the odometry.
    pub(super) fn before(&self, point: Point3, angles: &RingAngles) -> Before {
        let seen = self.direction(point);
        self.around(&seen, SAME_M, angles).verdict(point, &seen)
    }

    /// The lidar looked through a point of the frame of the odometry, where something stood at another time.
    pub(super) fn is_gone(&self, point: Point3, angles: &RingAngles) -> bool {
        let around = self.around(&self.direction(point), GONE_M, angles);
        !around.same && !around.unmeasured && around.behind_m.is_some_and(|(_, most_m)| most_m < 0.0)
    }

    /// Something stands before a point of the frame of the odometry.
    pub(super) fn is_hidden(&self, point: Point3, angles: &RingAngles) -> bool {
        matches!(self.before(point, angles), Before::Hidden | Before::JustBehind(_))
    }

    fn around(&self, seen: &Direction, same_m: f32, angles: &RingAngles) -> Around {
        let range_m = seen.range_m;
        let rings = neighbours(angles, seen.up_m, range_m);
        let middle = sector(seen.cdeg);
        let mut around = Around::default();
        for step in [SECTORS - 1, 0, 1] {
            let Some(sector) = self.nearest.get((middle + step) % SECTORS) else { continue };
            for ring in rings {
                match sector.get(ring).copied().unwrap_or(UNMEASURED) {
                    UNMEASURED => around.unmeasured = true,
                    NO_RETURN => {}
                    counts => around.note(range_m - f32::from(counts) * self.metres_per_count, same_m),
                }
            }
        }
        around
    }

    /// How the lidar saw a point then. While it turned, the robot drove: the beam's moment follows from the azimuth, in two rounds.
    fn direction(&self, point: Point3) -> Direction {
        let mut before_end_s = 0.0;
        let mut seen = Direction::default();
        for _ in 0..2 {
            let moved = Pose2::new(
                self.twist.linear_mps * before_end_s,
                0.0,
                self.twist.angular_radps * before_end_s,
            );
            seen = self.direction_from(self.base_in_odom.compose(moved), point);
            let turned_cdeg =
                (seen.cdeg + 36_000).saturating_sub(u32::from(self.first_azimuth_cdeg)) % 36_000;
            before_end_s = (turned_cdeg as f32 / 36_000.0 - 1.0) * self.duration_s;
        }
        seen
    }

    fn direction_from(&self, base_in_odom: Pose2, point: Point3) -> Direction {
        let [[cos, ..], [sin, ..], _] = self.sensor_in_base.rotation;
        let origin = self.sensor_in_base.translation;
        let sensor = base_in_odom.compose(Pose2::new(origin.x_m, origin.y_m, libm::atan2f(sin, cos)));
        let (dx, dy) = (point.x_m - sensor.x_m, point.y_m - sensor.y_m);
        let (sin, cos) = libm::sincosf(sensor.heading_rad);
        let (forward_m, left_m) = (cos * dx + sin * dy, cos * dy - sin * dx);
        let azimuth_rad = -libm::atan2f(left_m, forward_m);
        let cdeg = (azimuth_rad * (18_000.0 / core::f32::consts::PI) + 36_000.0) as u32 % 36_000;
        let up_m = point.z_m - origin.z_m;
        let range_m = libm::sqrtf(dx * dx + dy * dy + up_m * up_m);
        Direction { cdeg, range_m, up_m, sensor: Point3::new(sensor.x_m, sensor.y_m, origin.z_m) }
    }
}

/// A point this much nearer to the sensor.
fn towards(point: Point3, seen: &Direction, nearer_m: f32) -> Point3 {
    let share = (nearer_m / seen.range_m.max(0.1)).clamp(0.0, 1.0);
    let along = |from: f32, to: f32| from + share * (to - from);
    Point3::new(
        along(point.x_m, seen.sensor.x_m),
        along(point.y_m, seen.sensor.y_m),
        along(point.z_m, seen.sensor.z_m),
    )
}

fn sector(cdeg: u32) -> usize {
    (cdeg / SECTOR_CDEG) as usize % SECTORS
}

/// The rings whose beams pass just below and just above a point.
fn neighbours(angles: &RingAngles, up_m: f32, range_m: f32) -> [usize; 2] {
    let above = angles.rings.iter().position(|(sin, _, height_m)| sin * range_m + height_m >= up_m);
    let above = above.unwrap_or(SWEEP_RINGS - 1);
    [above.saturating_sub(1), above]
}

const _: () = assert!(SECTORS as u32 * SECTOR_CDEG == 36_000);
