//! The robot's own motion, as the guard ring estimates it.

use floorguard_localisation::odometry::{Odometry, OdometryNoise, WheelGeometry, WheelMotion, WheelOdometry};
use floorguard_types::geometry::{Pose2, Twist2};
use floorguard_types::sensing::{ImuSample, WheelSample};
use floorguard_types::time::Stamp;

/// Where the robot was at a moment, and how it moved.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct StampedPose {
    /// When.
    pub stamp: Stamp,
    /// In the odometry frame.
    pub pose_in_odometry: Pose2,
    /// In the robot's frame.
    pub twist: Twist2,
}

/// Wheels and gyroscope.
#[derive(Clone, Debug)]
pub struct Motion {
    wheels: WheelOdometry,
    /// That of `wheels` once more (FG-REQ-058).
    geometry: WheelGeometry,
    filter: Odometry,
    known: Option<Stamp>,
}

impl Motion {
    /// At the origin of the odometry frame.
    #[must_use]
    pub fn new(geometry: WheelGeometry) -> Self {
        Self {
            wheels: WheelOdometry::new(geometry),
            geometry,
            filter: Odometry::new(OdometryNoise::for_track(geometry.track_m)),
            known: None,
        }
    }

    /// Encoders; gives the motion that they measured.
    pub fn on_wheels(&mut self, sample: &WheelSample) -> Option<WheelMotion> {
        let motion = self.wheels.update(sample)?;
        self.filter.on_wheels(&motion);
        Some(motion)
    }

    /// Track and ticks of the wheels are what they were at the start; `false` after a flipped bit (FG-REQ-058).
    #[must_use]
    pub fn is_whole(&self) -> bool {
        self.wheels.geometry() == self.geometry
    }

    /// The motion that a base measured of itself.
    pub fn on_motion(&mut self, motion: &WheelMotion) {
        self.filter.on_wheels(motion);
    }

    /// Inertial measurement in the robot's axes.
    pub fn on_imu(&mut self, sample: &ImuSample) {
        self.filter.on_imu(sample);
    }

    /// The filter, for its counters and doubts.
    #[must_use]
    pub const fn filter(&self) -> &Odometry {
        &self.filter
    }

    /// The newest pose, if it is newer than the one given before.
    pub(super) fn newest(&mut self) -> Option<StampedPose> {
        let stamp = self.filter.stamp()?;
        if self.known.is_some_and(|known| stamp <= known) {
            return None;
        }
        self.known = Some(stamp);
        Some(StampedPose { stamp, pose_in_odometry: self.filter.pose(), twist: self.filter.twist() })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn fg_req_058_flipped_wheel_geometry_is_noticed() {
        let geometry = WheelGeometry { track_m: 0.6, ticks_per_m: 20_000.0, speed_max_mps: 1.0 };
        let mut motion = Motion::new(geometry);
        assert!(motion.is_whole());
        for bit in 0..32 {
            for part in 0..3 {
                motion.geometry = geometry;
                let WheelGeometry { track_m, ticks_per_m, speed_max_mps } = &mut motion.geometry;
                let number = [track_m, ticks_per_m, speed_max_mps].into_iter().nth(part).unwrap();
                *number = f32::from_bits(number.to_bits() ^ (1 << bit));
                assert!(!motion.is_whole(), "bit {bit} of {part}");
            }
        }
    }
}
