//! Follows a path of poses: forward pieces by pure pursuit (Coulter 1992), turns on the spot, backwards pieces.
//!
//! Backwards is pure pursuit as well: the mirrored robot drives forward. A piece ends where the gear changes, and the robot
//! comes to rest there. The path stays with the caller; the follower keeps an index.

use floorguard_types::geometry::{Point2, Pose2, Twist2, wrap_angle};
use floorguard_types::motion::{Gear, Waypoint};

use super::foot::{Foot, aim, foot};

/// How a backwards piece is steered.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Backing {
    /// By pure pursuit of the mirrored robot: round bends, and back to the line.
    #[default]
    Pursuit,
    /// Keeps to the headings of the waypoints: for straight pieces, on which the front is not to swing out.
    Heading,
}

/// Limits and gains.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FollowLimits {
    /// Forward, m/s, > 0.
    pub speed_mps: f32,
    /// Backwards, m/s, > 0.
    pub reverse_mps: f32,
    /// Turning rate, rad/s, > 0.
    pub turn_radps: f32,
    /// The point that the robot aims at lies this far ahead, metres, > 0.
    pub look_ahead_m: f32,
    /// Slowing down towards the end of a piece, m/s², > 0.
    pub easing_mps2: f32,
    /// A point farther to the side than this is turned to on the spot first, radians.
    pub turn_first_rad: f32,
    /// The end of a piece counts as reached within, metres.
    pub reached_m: f32,
    /// A heading counts as reached within, radians.
    pub aimed_rad: f32,
    /// Farther off the path it is given up, metres.
    pub lost_m: f32,
    /// How backwards pieces are steered.
    pub backing: Backing,
}

impl FollowLimits {
    /// A scrubber at walking pace.
    pub const DEFAULT: Self = Self {
        speed_mps: 0.8,
        reverse_mps: 0.2,
        turn_radps: 0.6,
        look_ahead_m: 0.45,
        easing_mps2: 0.4,
        turn_first_rad: 1.0,
        reached_m: 0.04,
        aimed_rad: 0.06,
        lost_m: 0.4,
        backing: Backing::Pursuit,
    };
    /// The slowest that still gets there, m/s.
    const CREEP_MPS: f32 = 0.08;
    /// The slowest that still turns, rad/s.
    const CREEP_RADPS: f32 = 0.15;
    /// Backwards by heading: turning rate per radian of error, 1/s, and the largest one, rad/s.
    const BACK_GAIN_PER_S: f32 = 0.8;
    const BACK_TURN_RADPS: f32 = 0.3;
}

/// What to do.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum FollowState {
    /// Drive like this.
    Drive(Twist2),
    /// The end of the path is reached.
    Arrived,
    /// The robot is not on its path any more; plan again.
    Lost,
}

/// A place on a path: the piece of one gear that is driven now.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct PathFollower {
    /// First waypoint of the piece; the one before it is where the piece begins.
    first: usize,
    /// One past its last waypoint.
    end: usize,
    /// The leg where the robot was, from the waypoint before `first`.
    leg: usize,
}

impl PathFollower {
    /// At the first waypoint of a path, where the robot is.
    #[must_use]
    pub fn new(path: &[Waypoint]) -> Self {
        let mut follower = Self::default();
        follower.begin(path, 1);
        follower
    }

    /// The waypoint that is driven to now.
    #[must_use]
    pub const fn next(&self) -> usize {
        self.first.saturating_add(self.leg)
    }

    /// Nothing of the path is left to drive.
    #[must_use]
    pub const fn is_over(&self, path: &[Waypoint]) -> bool {
        self.first >= path.len()
    }

    fn begin(&mut self, path: &[Waypoint], first: usize) {
        let rest = path.get(first..).unwrap_or(&[]);
        let gear = rest.first().map(|at| at.gear);
        let count = rest.iter().take_while(|at| Some(at.gear) == gear).count();
        *self = Self { first, end: first.saturating_add(count), leg: 0 };
    }

    /// What to do from a pose. The path must be the one that the follower was made for.
    pub fn follow(&mut self, path: &[Waypoint], pose_in_map: Pose2, limits: &FollowLimits) -> FollowState {
        if !(pose_in_map.x_m.is_finite() && pose_in_map.y_m.is_finite()) {
            return FollowState::Lost;
        }
        // Every turn ends a piece or returns; there are fewer pieces than waypoints.
        for _ in 0..=path.len() {
            let Some(last) = path.get(self.first..self.end).and_then(<[_]>::last).copied() else {
                return FollowState::Arrived;
            };
            let state = match last.gear {
                Gear::Spin => spin(pose_in_map, last.pose_in_map.heading_rad, limits),
                Gear::Ahead | Gear::Back => self.pursue(path, pose_in_map, limits),
            };
            if state != FollowState::Arrived {
                return state;
            }
            let next = self.end.max(self.first.saturating_add(1));
            self.begin(path, next);
        }
        FollowState::Arrived
    }

    /// Pure pursuit along the piece, forward or mirrored.
    fn pursue(&mut self, path: &[Waypoint], pose_in_map: Pose2, limits: &FollowLimits) -> FollowState {
        let piece = path.get(self.first.saturating_sub(1)..self.end).unwrap_or(&[]);
        let is_back = piece.last().is_some_and(|at| at.gear == Gear::Back);
        let here = Point2::new(pose_in_map.x_m, pose_in_map.y_m);
        let Some(at) = foot(piece, here, self.leg) else { return FollowState::Arrived };
        self.leg = at.leg;
        if at.left_m < limits.reached_m {
            return FollowState::Arrived;
        }
        if at.off_m > limits.lost_m {
            return FollowState::Lost;
        }
        if is_back && limits.backing == Backing::Heading {
            let heading_rad =
                path.get(self.next()).map_or(pose_in_map.heading_rad, |at| at.pose_in_map.heading_rad);
            return FollowState::Drive(back_by_heading(pose_in_map, heading_rad, limits));
        }
        let Some(target) = aim(piece, &at, limits.look_ahead_m) else { return FollowState::Arrived };
        let facing_rad = if is_back { core::f32::consts::PI } else { 0.0 };
        let mirrored = Pose2::new(pose_in_map.x_m, pose_in_map.y_m, pose_in_map.heading_rad + facing_rad);
        let top_mps = if is_back { limits.reverse_mps } else { limits.speed_mps };
        let twist = towards(mirrored.inverse().transform(target), &at, (top_mps, limits));
        let sign = if is_back { -1.0 } else { 1.0 };
        FollowState::Drive(Twist2 { linear_mps: sign * twist.linear_mps, ..twist })
    }
}

/// The arc through a point of the robot's frame, slower before the end and in bends.
fn towards(target_in_base: Point2, foot: &Foot, (top_mps, limits): (f32, &FollowLimits)) -> Twist2 {
    let bearing_rad = libm::atan2f(target_in_base.y_m, target_in_base.x_m);
    if libm::fabsf(bearing_rad) > limits.turn_first_rad {
        return Twist2 { linear_mps: 0.0, angular_radps: libm::copysignf(limits.turn_radps, bearing_rad) };
    }
    let Point2 { x_m, y_m } = target_in_base;
    let curvature_per_m = 2.0 * y_m / (x_m * x_m + y_m * y_m).max(0.01);
    let easing_mps =
        libm::sqrtf(2.0 * limits.easing_mps2 * foot.left_m.max(0.0)).max(FollowLimits::CREEP_MPS);
    Twist2::on_arc(curvature_per_m, top_mps.min(easing_mps), limits.turn_radps)
}

/// Straight back, and towards a heading.
fn back_by_heading(pose_in_map: Pose2, heading_rad: f32, limits: &FollowLimits) -> Twist2 {
    let limit_radps = FollowLimits::BACK_TURN_RADPS;
    let error_rad = wrap_angle(heading_rad - pose_in_map.heading_rad);
    let angular_radps = (FollowLimits::BACK_GAIN_PER_S * error_rad).clamp(-limit_radps, limit_radps);
    Twist2 { linear_mps: -limits.reverse_mps, angular_radps }
}

fn spin(pose_in_map: Pose2, heading_rad: f32, limits: &FollowLimits) -> FollowState {
    let error_rad = wrap_angle(heading_rad - pose_in_map.heading_rad);
    if libm::fabsf(error_rad) < limits.aimed_rad {
        return FollowState::Arrived;
    }
    let rate_radps = (1.5 * libm::fabsf(error_rad)).max(FollowLimits::CREEP_RADPS).min(limits.turn_radps);
    FollowState::Drive(Twist2 { linear_mps: 0.0, angular_radps: libm::copysignf(rate_radps, error_rad) })
}

#[cfg(test)]
mod tests {
    use super::*;
    use core::f32::consts::FRAC_PI_2;
    use proptest::prelude::*;
    use std::vec;
    use std::vec::Vec;

    fn at(x_m: f32, y_m: f32, heading_rad: f32, gear: Gear) -> Waypoint {
        Waypoint { pose_in_map: Pose2::new(x_m, y_m, heading_rad), gear }
    }

    /// Drives a perfect robot; gives where it was.
    fn drive(path: &[Waypoint], start: Pose2) -> (Vec<Pose2>, FollowState) {
        let mut follower = PathFollower::new(path);
        let (limits, mut pose) = (FollowLimits::DEFAULT, start);
        let mut poses = vec![pose];
        for _ in 0..4_000 {
            match follower.follow(path, pose, &limits) {
                FollowState::Drive(twist) => {
                    assert!(twist.linear_mps <= limits.speed_mps && twist.linear_mps >= -limits.reverse_mps);
                    assert!(twist.angular_radps.abs() <= limits.turn_radps + 1e-5);
                    pose = pose.after(twist, 0.05);
                    poses.push(pose);
                }
                end => return (poses, end),
            }
        }
        panic!("it never ends: {pose:?}");
    }

    #[test]
    fn drives_ahead_turns_and_backs_up() {
        let path = [
            at(0.0, 0.0, 0.0, Gear::Ahead),
            at(1.0, 0.0, 0.0, Gear::Ahead),
            at(2.0, 0.0, 0.0, Gear::Ahead),
            at(2.0, 0.0, FRAC_PI_2, Gear::Spin),
            at(2.0, 1.0, FRAC_PI_2, Gear::Ahead),
            at(2.0, 0.4, FRAC_PI_2, Gear::Back),
        ];
        let (poses, end) = drive(&path, Pose2::new(0.0, 0.1, 0.1));
        assert_eq!(end, FollowState::Arrived);
        assert!(poses.iter().any(|pose| pose.y_m > 0.9));
        let last = poses.last().unwrap();
        assert!((last.y_m - 0.4).abs() < 0.06 && (last.x_m - 2.0).abs() < 0.06, "{last:?}");
    }

    /// Backwards round a bend: the old followers could only back straight.
    #[test]
    fn backs_round_a_bend() {
        let bend: Vec<Waypoint> = (0..=20)
            .map(|step| {
                let angle = FRAC_PI_2 * step as f32 / 20.0;
                at(-2.0 * angle.sin(), 2.0 - 2.0 * angle.cos(), -angle, Gear::Back)
            })
            .collect();
        let (poses, end) = drive(&bend, Pose2::default());
        assert_eq!(end, FollowState::Arrived);
        let last = poses.last().unwrap();
        assert!(Point2::new(last.x_m, last.y_m).distance(Point2::new(-2.0, 2.0)) < 0.12, "{last:?}");
        assert!((last.heading_rad + FRAC_PI_2).abs() < 0.2, "{last:?}");
    }

    /// Beyond its end the last leg would cross the third one: nothing between them is left out.
    #[test]
    fn a_loop_is_driven_to_its_end() {
        let corners = [(0.0, 0.0), (1.2, 0.0), (1.8, 1.0), (4.2, 1.3), (4.3, 2.5), (3.1, 2.7), (2.5, 1.6)];
        let path = corners.map(|(x_m, y_m)| at(x_m, y_m, 0.0, Gear::Ahead));
        let (poses, end) = drive(&path, Pose2::default());
        let last = poses.last().unwrap();
        assert_eq!(end, FollowState::Arrived);
        assert!(Point2::new(last.x_m, last.y_m).distance(Point2::new(2.5, 1.6)) < 0.15, "{last:?}");
        assert!(poses.iter().any(|pose| pose.x_m > 4.0 && pose.y_m > 2.0), "round the loop");
    }

    /// By heading the line is not sought again: what is beside it stays so.
    #[test]
    fn backing_by_heading_does_not_swing() {
        let path = [at(0.0, 0.0, 0.0, Gear::Back), at(-2.0, 0.0, 0.0, Gear::Back)];
        let limits = FollowLimits { backing: Backing::Heading, ..FollowLimits::DEFAULT };
        let mut follower = PathFollower::new(&path);
        let beside = follower.follow(&path, Pose2::new(-0.5, 0.2, 0.0), &limits);
        assert_eq!(beside, FollowState::Drive(Twist2 { linear_mps: -0.2, angular_radps: 0.0 }));
        let turned = follower.follow(&path, Pose2::new(-0.5, 0.0, 0.1), &limits);
        let FollowState::Drive(twist) = turned else { panic!("{turned:?}") };
        assert!((twist.angular_radps + 0.08).abs() < 1e-6, "{twist:?}");
        assert!(!follower.is_over(&path) && PathFollower::new(&[]).is_over(&[]));
    }

    #[test]
    fn off_path_is_lost_empty_path_is_over() {
        let path = [at(0.0, 0.0, 0.0, Gear::Ahead), at(2.0, 0.0, 0.0, Gear::Ahead)];
        let limits = FollowLimits::DEFAULT;
        let mut follower = PathFollower::new(&path);
        assert_eq!(follower.follow(&path, Pose2::new(1.0, 0.6, 0.0), &limits), FollowState::Lost);
        let nowhere = Pose2 { x_m: f32::NAN, ..Pose2::default() };
        assert_eq!(follower.follow(&path, nowhere, &limits), FollowState::Lost);
        assert_eq!(PathFollower::new(&[]).follow(&[], Pose2::default(), &limits), FollowState::Arrived);
    }

    proptest! {
        /// Any polyline with bends of at most 90° is driven to its end, never farther off than the limit.
        #[test]
        fn every_polyline_is_driven(turns in prop::collection::vec(-1.5_f32..1.5, 1..8)) {
            let mut path = vec![at(0.0, 0.0, 0.0, Gear::Ahead)];
            let mut heading_rad = 0.0_f32;
            for turn_rad in turns {
                let last = path.last().unwrap().pose_in_map;
                path.push(at(last.x_m + 1.2 * heading_rad.cos(), last.y_m + 1.2 * heading_rad.sin(), heading_rad, Gear::Ahead));
                heading_rad += turn_rad;
            }
            let (poses, end) = drive(&path, Pose2::default());
            prop_assert_eq!(end, FollowState::Arrived);
            let last = poses.last().unwrap();
            let goal = path.last().unwrap().place_in_map();
            prop_assert!(Point2::new(last.x_m, last.y_m).distance(goal) < 0.15);
        }
    }
}
