//! The odometry of the last second: where the robot was when a scan was measured.

use std::collections::VecDeque;

use floorguard_runtime::shared::StampedPose;
use floorguard_types::geometry::{Pose2, wrap_angle};
use floorguard_types::time::Stamp;

/// Poses that are kept: a second of odometry.
const POSES: usize = 24;

/// The newest poses in the odometry frame, in the order of their arrival.
#[derive(Clone, Debug, Default)]
pub struct RecentPoses(VecDeque<StampedPose>);

impl RecentPoses {
    /// Nothing was remembered yet.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.0.is_empty()
    }

    /// Keeps a pose; a full table drops the oldest.
    pub fn push(&mut self, pose: StampedPose) {
        self.0.push_back(pose);
        if self.0.len() > POSES {
            self.0.pop_front();
        }
    }

    /// Between the poses around a moment, odometry frame; the nearest one outside, none if nothing was remembered.
    #[must_use]
    pub fn at(&self, stamp: Stamp) -> Option<Pose2> {
        let after = self.0.iter().position(|known| known.stamp >= stamp);
        let pair = after.and_then(|after| Some((self.0.get(after.checked_sub(1)?)?, self.0.get(after)?)));
        let Some((from, to)) = pair else {
            let edge = if after.is_some() { self.0.front() } else { self.0.back() };
            return edge.map(|known| known.pose_in_odometry);
        };
        let micros = |stamp: Stamp| stamp.as_micros().saturating_sub(from.stamp.as_micros()) as f32;
        let t = micros(stamp) / micros(to.stamp).max(1.0);
        let (a, b) = (from.pose_in_odometry, to.pose_in_odometry);
        let turned_rad = wrap_angle(b.heading_rad - a.heading_rad);
        Some(Pose2::new(
            a.x_m + t * (b.x_m - a.x_m),
            a.y_m + t * (b.y_m - a.y_m),
            wrap_angle(a.heading_rad + t * turned_rad),
        ))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn poses_are_interpolated_inside_and_held_outside() {
        let at = |ms: u64| Stamp::from_micros(ms * 1_000);
        let mut poses = RecentPoses::default();
        assert_eq!(poses.at(at(5)), None);
        for (ms, x_m) in [(100, 0.0), (200, 1.0)] {
            let pose_in_odometry = Pose2::new(x_m, 0.0, 0.0);
            poses.push(StampedPose { stamp: at(ms), pose_in_odometry, ..StampedPose::default() });
        }
        let x_m = |ms| poses.at(at(ms)).map(|pose| pose.x_m);
        assert_eq!([50, 125, 200, 900].map(x_m), [0.0, 0.25, 1.0, 1.0].map(Some));
    }
}
