//! Odometry over time.

use crate::se2::Se2;

/// Between two poses farther apart in time the motion is not known, seconds.
const GAP_S: f64 = 0.5;
/// Beyond the first and the last pose it is known for so long, seconds.
const BEYOND_S: f64 = 0.1;

/// Faster, m/s and rad/s, odometry was set anew. The turn must stay below half a turn a second, where a rate would be wrapped.
const SPEED_MAX: (f64, f64) = (5.0, 3.0);

/// Poses of the robot in the frame of its odometry, ordered by time.
#[derive(Clone, Debug, Default)]
pub struct OdometryTrack(Vec<(f64, Se2)>);

impl OdometryTrack {
    /// Enters a pose; one that is not later than the last is left out.
    pub fn push(&mut self, time_s: f64, pose: Se2) {
        let is_finite = pose.x_m.is_finite() && pose.y_m.is_finite() && pose.heading_rad.is_finite();
        if is_finite && self.0.last().is_none_or(|(last_s, _)| time_s > *last_s) {
            self.0.push((time_s, pose));
        }
    }

    /// No pose.
    pub fn is_empty(&self) -> bool {
        self.0.is_empty()
    }

    /// Speed and turning rate without their signs, m/s and rad/s, between the two poses around a time; `None` in a gap.
    pub fn speed_at(&self, time_s: f64) -> Option<[f64; 2]> {
        let after = self.0.partition_point(|(other_s, _)| *other_s < time_s);
        let (to_s, to) = self.0.get(after)?;
        let (from_s, from) = self.0.get(after.checked_sub(1)?)?;
        let motion = from.between(*to);
        let seconds = to_s - from_s;
        (seconds <= GAP_S).then(|| [motion.length_m() / seconds, motion.heading_rad.abs() / seconds])
    }

    /// Motion a second of what is mounted on the robot, in its own frame, between the two poses around a time; `None` in a gap and
    /// where odometry jumps.
    pub fn motion_at(&self, time_s: f64, mounted: Se2) -> Option<Se2> {
        let after = self.0.partition_point(|(other_s, _)| *other_s < time_s);
        let (to_s, to) = self.0.get(after)?;
        let (from_s, from) = self.0.get(after.checked_sub(1)?)?;
        let seconds = to_s - from_s;
        let motion = from.compose(mounted).between(to.compose(mounted)).scaled(1.0 / seconds);
        let is_steady =
            seconds <= GAP_S && motion.length_m() <= SPEED_MAX.0 && motion.heading_rad.abs() <= SPEED_MAX.1;
        is_steady.then_some(motion)
    }

    /// The pose at a time, between the two poses around it; `None` where odometry has a gap.
    pub fn at(&self, time_s: f64) -> Option<Se2> {
        let after = self.0.partition_point(|(other_s, _)| *other_s < time_s);
        let later = self.0.get(after);
        let earlier = after.checked_sub(1).and_then(|before| self.0.get(before));
        match (earlier, later) {
            (Some((from_s, from)), Some((to_s, to))) if to_s - from_s <= GAP_S => {
                let share = (time_s - from_s) / (to_s - from_s);
                Some(from.compose(from.between(*to).scaled(share)))
            }
            _ => {
                let near = [earlier, later].into_iter().flatten();
                let away = |other_s: f64| (other_s - time_s).abs();
                near.filter(|(other_s, _)| away(*other_s) <= BEYOND_S)
                    .min_by(|a, b| away(a.0).total_cmp(&away(b.0)))
                    .map(|(_, pose)| *pose)
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn gaps_are_not_bridged() {
        let mut track = OdometryTrack::default();
        track.push(1.0, Se2::new(0.0, 0.0, 0.0));
        track.push(1.2, Se2::new(0.2, 0.0, 0.4));
        track.push(1.1, Se2::new(9.0, 0.0, 0.0));
        track.push(5.0, Se2::new(3.0, 0.0, 0.0));
        let middle = track.at(1.1).unwrap();
        assert!((middle.x_m - 0.1).abs() < 1e-9 && (middle.heading_rad - 0.2).abs() < 1e-9, "{middle:?}");
        assert_eq!([track.at(3.0), track.at(0.5), track.at(5.2)], [None; 3]);
        assert_eq!(track.at(1.25), Some(Se2::new(0.2, 0.0, 0.4)));
        let scanner = Se2::new(1.0, 0.0, 0.0);
        let motion = track.motion_at(1.1, scanner).unwrap();
        // 1 m/s ahead, and a metre ahead of the axle some 2 m/s to the left.
        assert!((0.5..0.7).contains(&motion.x_m) && (motion.y_m - 1.95).abs() < 0.1, "{motion:?}");
        assert!((motion.heading_rad - 2.0).abs() < 1e-9, "{motion:?}");
        assert_eq!([track.motion_at(3.0, scanner), track.motion_at(5.2, scanner)], [None; 2]);
    }
}
