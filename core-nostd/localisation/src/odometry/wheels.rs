//! From two tick counters to a motion of the rear axle (book, Odometry: Wheels).

use floorguard_types::geometry::{Pose2, Twist2};
use floorguard_types::number::nearest_f32;
use floorguard_types::sensing::WheelSample;
use floorguard_types::time::{Age, Stamp};

/// The two measuring wheels.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct WheelGeometry {
    /// Distance between the wheels, metres, > 0.
    pub track_m: f32,
    /// Encoder ticks per metre rolled, > 0.
    pub ticks_per_m: f32,
    /// The robot cannot drive faster, m/s; what counts more than 1.5 times as fast is refused.
    pub speed_max_mps: f32,
}

/// Motion between two samples.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct WheelMotion {
    /// When the later sample was taken.
    pub stamp: Stamp,
    /// Mean velocity of the middle of the rear axle.
    pub twist: Twist2,
    /// Travel of the middle of the rear axle, metres.
    pub distance_m: f32,
    /// Change of heading, radians.
    pub turn_rad: f32,
    /// Neither counter moved.
    pub still: bool,
}

impl WheelMotion {
    /// The motion as a pose: where the robot is after it, seen from where it was. Exact for a circular arc.
    #[must_use]
    pub fn arc(&self) -> Pose2 {
        if libm::fabsf(self.turn_rad) < 1.0e-6 {
            let (sin, cos) = libm::sincosf(self.turn_rad * 0.5);
            return Pose2::new(self.distance_m * cos, self.distance_m * sin, self.turn_rad);
        }
        let radius_m = self.distance_m / self.turn_rad;
        let (sin, cos) = libm::sincosf(self.turn_rad);
        Pose2::new(radius_m * sin, radius_m * (1.0 - cos), self.turn_rad)
    }
}

/// Shorter steps say nothing about a speed, microseconds.
const STEP_MIN_US: u64 = 100;
/// After a longer gap the counters may have turned any number of times, microseconds.
const STEP_MAX_US: u64 = 1_000_000;
/// Faster than this many times the greatest speed is a broken counter, not a motion.
const IMPLAUSIBLE: f32 = 1.5;

/// Differences of samples.
///
/// ```
/// use floorguard_localisation::odometry::{WheelGeometry, WheelOdometry};
/// use floorguard_types::{sensing::WheelSample, time::Stamp};
///
/// let geometry = WheelGeometry { track_m: 0.6, ticks_per_m: 20_000.0, speed_max_mps: 1.0 };
/// let mut wheels = WheelOdometry::new(geometry);
/// let sample = |micros, left_ticks, right_ticks| {
///     WheelSample { stamp: Stamp::from_micros(micros), left_ticks, right_ticks }
/// };
/// assert_eq!(wheels.update(&sample(0, 0, 0)), None);
/// let motion = wheels.update(&sample(50_000, 480, 520)).unwrap();
/// assert!((motion.twist.linear_mps - 0.5).abs() < 1.0e-6);
/// assert!((motion.twist.angular_radps - 0.066_666_7).abs() < 1.0e-6);
/// // A jump of five metres is no motion.
/// assert_eq!(wheels.update(&sample(100_000, 100_480, 520)), None);
/// ```
#[derive(Clone, Copy, Debug)]
pub struct WheelOdometry {
    geometry: WheelGeometry,
    last: Option<WheelSample>,
    refused: u32,
}

impl WheelOdometry {
    /// Without a first sample.
    #[must_use]
    pub const fn new(geometry: WheelGeometry) -> Self {
        Self { geometry, last: None, refused: 0 }
    }

    /// The wheels that it reckons with.
    #[must_use]
    pub const fn geometry(&self) -> WheelGeometry {
        self.geometry
    }

    /// The motion since the sample before. `None` for the first one, after a gap, for a stamp that does not advance,
    /// and for a jump that no wheel can make (counted).
    pub fn update(&mut self, sample: &WheelSample) -> Option<WheelMotion> {
        let Some(last) = self.last else {
            self.last = Some(*sample);
            return None;
        };
        let step_us = match last.stamp.age(sample.stamp) {
            Age::Past(step_us) if step_us >= STEP_MIN_US => step_us,
            Age::Past(_) | Age::Future(_) => return None,
        };
        self.last = Some(*sample);
        if step_us > STEP_MAX_US {
            return None;
        }
        let seconds = nearest_f32(step_us) * 1.0e-6;
        let ticks_per_m = self.geometry.ticks_per_m.max(1.0e-3);
        let path_m = |now: i32, before: i32| nearest_f32(now.wrapping_sub(before)) / ticks_per_m;
        let left_m = path_m(sample.left_ticks, last.left_ticks);
        let right_m = path_m(sample.right_ticks, last.right_ticks);
        let distance_m = (left_m + right_m) * 0.5;
        let turn_rad = (right_m - left_m) / self.geometry.track_m.max(1.0e-3);
        let fastest_m = libm::fabsf(left_m).max(libm::fabsf(right_m));
        // A wheel of a turning robot is faster than its middle: one more track width per radian.
        if fastest_m > IMPLAUSIBLE * (self.geometry.speed_max_mps + self.geometry.track_m) * seconds {
            self.refused = self.refused.saturating_add(1);
            return None;
        }
        Some(WheelMotion {
            stamp: sample.stamp,
            twist: Twist2 { linear_mps: distance_m / seconds, angular_radps: turn_rad / seconds },
            distance_m,
            turn_rad,
            still: left_m == 0.0 && right_m == 0.0,
        })
    }

    /// Jumps that were refused.
    #[must_use]
    pub const fn refused(&self) -> u32 {
        self.refused
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const GEOMETRY: WheelGeometry = WheelGeometry { track_m: 0.6, ticks_per_m: 20_000.0, speed_max_mps: 1.0 };

    fn sample(micros: u64, left_ticks: i32, right_ticks: i32) -> WheelSample {
        WheelSample { stamp: Stamp::from_micros(micros), left_ticks, right_ticks }
    }

    /// The test values of the book, Odometry: Wheels: wheels at 0.48 and 0.52 m/s for 50 ms from a heading of 0.3 rad.
    #[test]
    fn published_vector() {
        let mut wheels = WheelOdometry::new(GEOMETRY);
        assert_eq!(wheels.update(&sample(0, 0, 0)), None);
        let motion = wheels.update(&sample(50_000, 480, 520)).unwrap();
        assert!((motion.twist.linear_mps - 0.5).abs() < 1e-6);
        assert!((motion.twist.angular_radps - 0.066_666_7).abs() < 1e-6);
        let pose = Pose2::new(0.0, 0.0, 0.3).compose(motion.arc());
        assert!((pose.x_m - 0.023_871_1).abs() < 1e-6, "{pose:?}");
        assert!((pose.y_m - 0.007_427_8).abs() < 1e-6, "{pose:?}");
        assert!((pose.heading_rad - 0.303_333_3).abs() < 1e-6, "{pose:?}");
    }

    #[test]
    fn counters_wrap_without_a_jump() {
        let mut wheels = WheelOdometry::new(GEOMETRY);
        wheels.update(&sample(0, i32::MAX - 99, i32::MIN + 50));
        let motion = wheels.update(&sample(10_000, i32::MIN + 100, i32::MIN + 250)).unwrap();
        assert!((motion.distance_m - 0.01).abs() < 1e-6 && motion.turn_rad.abs() < 1e-6);
        assert_eq!(wheels.refused(), 0);
    }

    #[test]
    fn jumps_gaps_and_old_stamps_are_no_motion() {
        let mut wheels = WheelOdometry::new(GEOMETRY);
        wheels.update(&sample(10_000, 0, 0));
        assert_eq!(wheels.update(&sample(20_000, 100_000, 0)), None);
        assert_eq!(wheels.refused(), 1);
        assert_eq!(wheels.update(&sample(15_000, 100_000, 0)), None);
        assert_eq!(wheels.update(&sample(20_050, 100_000, 0)), None);
        assert_eq!(wheels.update(&sample(5_000_000, 100_000, 0)), None);
        assert!(wheels.update(&sample(5_010_000, 100_000, 0)).unwrap().still);
    }
}
