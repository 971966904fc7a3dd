//! The way that the robot came, for backing out.

use floorguard_types::geometry::{Point2, Pose2};
use floorguard_types::motion::{Gear, Waypoint};

/// Poses that are kept: 6.4 m.
pub const TRAIL_POSES: usize = 64;
/// From pose to pose, metres.
const SPACING_M: f32 = 0.1;

/// The newest poses of a drive. Older ones are forgotten when it is full.
#[derive(Clone, Debug, Default)]
pub struct Trail {
    poses: heapless::Deque<Pose2, TRAIL_POSES>,
}

impl Trail {
    /// The robot is here; a pose nearer to the last one than 0.1 m is not kept, nor one that is not finite.
    pub fn note(&mut self, pose_in_map: Pose2) {
        let here = Point2::new(pose_in_map.x_m, pose_in_map.y_m);
        let is_new =
            self.poses.back().is_none_or(|last| here.distance(Point2::new(last.x_m, last.y_m)) >= SPACING_M);
        if !is_new || !here.norm().is_finite() {
            return;
        }
        if self.poses.is_full() {
            let _ = self.poses.pop_front();
        }
        // The oldest one has left.
        let _ = self.poses.push_back(pose_in_map);
    }

    /// Writes the way back, at most so many metres, as waypoints in reverse gear from `pose_in_map` on; gives how many. Fewer
    /// than two: there is no way back. What is given is forgotten. Cost: one step a pose.
    pub fn way_back(&mut self, pose_in_map: Pose2, length_m: f32, path: &mut [Waypoint]) -> usize {
        let mut written = 0_usize;
        let (mut left_m, mut before) = (length_m, Point2::new(pose_in_map.x_m, pose_in_map.y_m));
        let mut add = |pose_in_map: Pose2| {
            if let Some(slot) = path.get_mut(written) {
                *slot = Waypoint { pose_in_map, gear: Gear::Back };
                written = written.saturating_add(1);
            }
        };
        add(pose_in_map);
        for _ in 0..TRAIL_POSES {
            if left_m <= 0.0 {
                break;
            }
            let Some(pose) = self.poses.pop_back() else { break };
            let place = Point2::new(pose.x_m, pose.y_m);
            left_m -= place.distance(before);
            before = place;
            add(pose);
        }
        written
    }

    /// Forgets everything: the robot was moved by others.
    pub fn clear(&mut self) {
        self.poses.clear();
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_way_back_is_reversed_and_bounded() {
        let mut trail = Trail::default();
        for step in 0..100_i16 {
            trail.note(Pose2::new(0.25 * f32::from(step), 0.0, 0.0));
            trail.note(Pose2::new(0.25 * f32::from(step) + 0.05, 0.0, 0.0));
        }
        trail.note(Pose2::new(f32::NAN, 0.0, 0.0));
        let mut path = [Waypoint::default(); 100];
        let count = trail.way_back(Pose2::new(25.0, 0.0, 0.0), 1.0, &mut path);
        let way = &path[..count];
        assert!(way.iter().all(|at| at.gear == Gear::Back));
        assert!(way.windows(2).all(|pair| pair[1].pose_in_map.x_m < pair[0].pose_in_map.x_m), "{way:?}");
        assert_eq!((count, way[count - 1].pose_in_map.x_m), (5, 24.0));
        // The newest 64 poses are kept, and not more; of them 60 are left. Then nothing is.
        let count = trail.way_back(Pose2::new(24.0, 0.0, 0.0), 100.0, &mut path);
        assert_eq!((count, path[count - 1].pose_in_map.x_m), (61, 9.0));
        assert_eq!(trail.way_back(Pose2::default(), 1.0, &mut path), 1);
    }
}
