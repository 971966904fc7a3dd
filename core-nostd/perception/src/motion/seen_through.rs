//! What the space held a moment ago, as the lidar saw it then: free, the same surface, hidden, or unknown.
//!
//! A static object that comes out from behind another fills voxels that were empty before, just like one that moves.
//! The range image of the moment before tells them apart: only where the lidar looked through, something has come.

use crate::clusters::RingAngles;
use crate::people::SweepContext;
use floorguard_types::capacities::{SWEEP_COLUMNS, SWEEP_RINGS};
use floorguard_types::geometry::{Point3, Twist2};
use floorguard_types::number::{count_u32, exact_usize, nearest_f32, saturating_u32};
use floorguard_types::profile::Profile;
use floorguard_types::sensing::SweepOf;

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
/// What stood nearer by at most this may be the object itself, which has receded since, metres: a person and a
/// stride.
const RECEDED_M: f32 = 0.8;

/// What was where a point is now.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Before {
    /// The lidar looked through.
    Free,
    /// Hidden behind a surface not far in front, here in the frame of the odometry: if that is gone now, it was the
    /// object itself, which has receded since.
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
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct SeenThrough {
    /// Counts of `metres_per_count`.
    nearest: [[u16; SWEEP_RINGS]; SECTORS],
    metres_per_count: f32,
    first_azimuth_cdeg: u16,
    duration_s: f32,
    lidar: LidarMotion,
}

impl SeenThrough {
    pub(super) const fn new() -> Self {
        Self {
            nearest: [[UNMEASURED; SWEEP_RINGS]; SECTORS],
            metres_per_count: 0.002,
            first_azimuth_cdeg: 0,
            duration_s: 0.0,
            lidar: LidarMotion::NEW,
        }
    }

    /// Takes a sweep as the moment before.
    pub(super) fn take<P: Profile>(&mut self, sweep: &SweepOf<P>, context: &SweepContext) {
        self.nearest.fill([UNMEASURED; SWEEP_RINGS]);
        self.metres_per_count = f32::from(sweep.range_unit_mm) * 1.0e-3;
        self.first_azimuth_cdeg = sweep.used_columns().first().map_or(0, |column| column.azimuth_cdeg);
        self.duration_s = sweep.end_stamp.seconds_since(sweep.stamp);
        self.lidar = LidarMotion::new(context);
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

    /// How the lidar saw a point then. While it turned, the robot drove: the beam's moment follows from the azimuth, in
    /// two rounds.
    fn direction(&self, point: Point3) -> Direction {
        let first = self.lidar.direction(point, 0.0);
        if self.lidar.is_still {
            return first;
        }
        let turned_cdeg = (first.cdeg + 36_000).saturating_sub(u32::from(self.first_azimuth_cdeg)) % 36_000;
        let before_end_s = (nearest_f32(turned_cdeg) / 36_000.0 - 1.0) * self.duration_s;
        self.lidar.direction(point, before_end_s)
    }
}

/// The lidar at the end of a sweep and how it moved, in the frame of the odometry.
#[derive(Clone, Copy, Debug, PartialEq)]
struct LidarMotion {
    place: Point3,
    sin: f32,
    cos: f32,
    velocity: [f32; 2],
    turn_radps: f32,
    is_still: bool,
}

impl LidarMotion {
    const NEW: Self = Self {
        place: Point3 { x_m: 0.0, y_m: 0.0, z_m: 0.0 },
        sin: 0.0,
        cos: 1.0,
        velocity: [0.0; 2],
        turn_radps: 0.0,
        is_still: true,
    };

    fn new(context: &SweepContext) -> Self {
        let [[cos, ..], [sin, ..], _] = context.sensor_in_base.rotation;
        let mount = context.sensor_in_base.translation;
        let base = context.base_in_odom;
        let (base_sin, base_cos) = libm::sincosf(base.heading_rad);
        let turned = |x: f32, y: f32| (base_cos * x - base_sin * y, base_sin * x + base_cos * y);
        let (dx, dy) = turned(mount.x_m, mount.y_m);
        // The yaw of the mounting; a small roll or pitch does not matter here.
        let scale = 1.0 / libm::sqrtf(sin * sin + cos * cos).max(1.0e-6);
        let (cos, sin) = turned(cos * scale, sin * scale);
        let twist = context.twist;
        let (vx, vy) =
            turned(twist.linear_mps - twist.angular_radps * mount.y_m, twist.angular_radps * mount.x_m);
        Self {
            place: Point3::new(base.x_m + dx, base.y_m + dy, mount.z_m),
            sin,
            cos,
            velocity: [vx, vy],
            turn_radps: twist.angular_radps,
            is_still: twist == Twist2::ZERO,
        }
    }

    /// Within a sweep the travel is short: straight, and turns are small angles.
    fn direction(&self, point: Point3, before_end_s: f32) -> Direction {
        let [vx, vy] = self.velocity;
        let turn_rad = self.turn_radps * before_end_s;
        let place = Point3::new(
            self.place.x_m + vx * before_end_s,
            self.place.y_m + vy * before_end_s,
            self.place.z_m,
        );
        let (dx, dy) = (point.x_m - place.x_m, point.y_m - place.y_m);
        let (x, y) = (self.cos * dx + self.sin * dy, self.cos * dy - self.sin * dx);
        // The turn, to second order: 10⁻³ rad at most for a turn of 0.2 rad a sweep.
        let shrink = 1.0 - 0.5 * turn_rad * turn_rad;
        let (forward_m, left_m) = (shrink * x + turn_rad * y, shrink * y - turn_rad * x);
        let up_m = point.z_m - place.z_m;
        let range_m = libm::sqrtf(dx * dx + dy * dy + up_m * up_m);
        Direction { cdeg: azimuth_cdeg(forward_m, left_m), range_m, up_m, sensor: place }
    }
}

/// Clockwise from ahead, hundredths of a degree, right to 2: a polynomial of the tangent within ±45°, and symmetry.
fn azimuth_cdeg(forward_m: f32, left_m: f32) -> u32 {
    const CDEG_PER_RAD: f32 = 18_000.0 / core::f32::consts::PI;
    let right_m = -left_m;
    let (far, near) = (forward_m.abs().max(right_m.abs()), forward_m.abs().min(right_m.abs()));
    let tangent = near / far.max(1.0e-6);
    let square = tangent * tangent;
    // Abramowitz and Stegun 4.4.49: within 10⁻⁵ rad.
    let series = 0.999_866
        + square * (-0.330_299_5 + square * (0.180_141 + square * (-0.085_133 + square * 0.020_835_1)));
    let angle = tangent * series * CDEG_PER_RAD;
    let from_ahead = if right_m.abs() > forward_m.abs() { 9_000.0 - angle } else { angle };
    let half = if forward_m < 0.0 { 18_000.0 - from_ahead } else { from_ahead };
    let whole = if right_m < 0.0 { 36_000.0 - half } else { half };
    saturating_u32(whole) % 36_000
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
    exact_usize(cdeg / SECTOR_CDEG) % SECTORS
}

/// The rings whose beams pass just below and just above a point.
fn neighbours(angles: &RingAngles, up_m: f32, range_m: f32) -> [usize; 2] {
    let above = angles.rings.iter().position(|(sin, _, height_m)| sin * range_m + height_m >= up_m);
    let above = above.unwrap_or(SWEEP_RINGS - 1);
    [above.saturating_sub(1), above]
}

const _: () = assert!(count_u32(SECTORS) * SECTOR_CDEG == 36_000);

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn azimuths_agree_with_the_library_all_around() {
        for step in 0..3_600 {
            let angle_rad = step as f64 / 1_800.0 * core::f64::consts::PI;
            let (forward, right) = (libm::cos(angle_rad) * 3.0, libm::sin(angle_rad) * 3.0);
            let found = i64::from(azimuth_cdeg(forward as f32, -right as f32));
            let apart = (found - i64::from(step) * 10).rem_euclid(36_000);
            assert!(apart.min(36_000 - apart) <= 2, "{step}: {found}");
        }
        let _ = azimuth_cdeg(f32::NAN, 0.0);
        assert_eq!(azimuth_cdeg(0.0, 0.0), 0);
    }
}
