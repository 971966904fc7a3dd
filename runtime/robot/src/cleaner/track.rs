//! Drives a path of the lattice: forward pieces by pure pursuit, turns on the spot, backwards pieces
//! straight.

use floorguard_types::geometry::{Point2, Pose2, Twist2, wrap_angle};

use super::lattice::{Gear, Pace, Waypoint};

/// The point that the robot aims at lies this far ahead, metres.
const LOOK_AHEAD_M: f32 = 0.45;
/// Cross-track error at which the path is given up, metres.
const LOST_M: f32 = 0.4;
/// A heading within this is reached, radians.
const AIMED_RAD: f32 = 0.06;
/// A point farther to the side than this is turned to first, radians.
const ASIDE_RAD: f32 = 1.0;
/// Slowing down before an end, m/s².
const EASE_MPS2: f32 = 0.4;
/// The slowest that still gets there, m/s and rad/s.
const CRAWL: (f32, f32) = (0.08, 0.15);

/// Legs that may be reached from one step to the next.
const LEGS_AHEAD: usize = 5;

/// What to do next.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Tracking {
    /// Drive like this.
    Drive(Twist2),
    /// The end is reached.
    Arrived,
    /// The robot has left its path.
    Lost,
}

/// A path being driven.
#[derive(Clone, Debug, Default)]
pub struct Track {
    path: Vec<Waypoint>,
    /// The piece of one gear that is driven now: its first and one past its last waypoint.
    piece: (usize, usize),
    at: usize,
}

impl Track {
    /// A path from its first waypoint, where the robot is.
    pub fn new(path: Vec<Waypoint>) -> Self {
        let mut track = Self { path, piece: (0, 0), at: 0 };
        track.begin(1);
        track
    }

    /// Nothing is left to drive.
    pub fn is_over(&self) -> bool {
        self.piece.0 >= self.path.len()
    }

    /// What is still to be driven.
    pub fn rest(&self) -> &[Waypoint] {
        self.path.get(self.at..).unwrap_or(&[])
    }

    fn begin(&mut self, first: usize) {
        let gear = self.path.get(first).map(|at| at.gear);
        let rest = self.path.get(first..).unwrap_or(&[]);
        let count = rest.iter().take_while(|at| Some(at.gear) == gear).count();
        self.piece = (first, first + count);
        self.at = first;
    }

    /// What to do from a pose in the map frame.
    pub fn follow(&mut self, pose: Pose2, pace: &Pace) -> Tracking {
        // Every turn ends a piece or returns; there are fewer pieces than waypoints.
        for _ in 0..=self.path.len() {
            let Some(end) = self.path.get(self.piece.0..self.piece.1).and_then(<[_]>::last).copied() else {
                return Tracking::Arrived;
            };
            let tracking = match end.gear {
                Gear::Spin => spin(pose, end.pose.heading_rad, pace),
                Gear::Back => self.back(pose, pace),
                Gear::Ahead => self.ahead(pose, pace),
            };
            match tracking {
                Tracking::Arrived => self.begin(self.piece.1.max(self.piece.0 + 1)),
                other => return other,
            }
        }
        Tracking::Arrived
    }

    /// The corner points of the piece, with the one where it begins.
    fn points(&self) -> &[Waypoint] {
        self.path.get(self.piece.0.saturating_sub(1)..self.piece.1).unwrap_or(&[])
    }

    /// Where on the piece the robot is; or that it need not go on, or cannot.
    fn advance(&mut self, pose: Pose2) -> Result<Foot, Tracking> {
        let here = Point2::new(pose.x_m, pose.y_m);
        let foot = foot_of(self.points(), (here, self.at - self.piece.0)).ok_or(Tracking::Arrived)?;
        self.at = self.piece.0 + foot.leg;
        if foot.left_m < 0.04 {
            return Err(Tracking::Arrived);
        }
        if foot.off_m > LOST_M {
            return Err(Tracking::Lost);
        }
        Ok(foot)
    }

    fn ahead(&mut self, pose: Pose2, pace: &Pace) -> Tracking {
        let foot = match self.advance(pose) {
            Ok(foot) => foot,
            Err(end) => return end,
        };
        let aim = aim_of(self.points(), &foot, LOOK_AHEAD_M);
        let in_robot = pose.inverse().transform(aim);
        let bearing_rad = in_robot.y_m.atan2(in_robot.x_m);
        if bearing_rad.abs() > ASIDE_RAD {
            let turn_radps = pace.turn_radps.copysign(bearing_rad);
            return Tracking::Drive(Twist2 { linear_mps: 0.0, angular_radps: turn_radps });
        }
        let squared = (in_robot.x_m * in_robot.x_m + in_robot.y_m * in_robot.y_m).max(0.01);
        let curvature_per_m = 2.0 * in_robot.y_m / squared;
        let bend_mps = pace.turn_radps / curvature_per_m.abs().max(1.0e-3);
        let ease_mps = (2.0 * EASE_MPS2 * foot.left_m).sqrt().max(CRAWL.0);
        let linear_mps = pace.speed_mps.min(bend_mps).min(ease_mps);
        Tracking::Drive(Twist2 { linear_mps, angular_radps: linear_mps * curvature_per_m })
    }

    fn back(&mut self, pose: Pose2, pace: &Pace) -> Tracking {
        if let Err(end) = self.advance(pose) {
            return end;
        }
        let heading_rad = self.path.get(self.at).map_or(pose.heading_rad, |at| at.pose.heading_rad);
        let error_rad = wrap_angle(heading_rad - pose.heading_rad);
        Tracking::Drive(Twist2 {
            linear_mps: -pace.reverse_mps,
            angular_radps: (0.8 * error_rad).clamp(-0.3, 0.3),
        })
    }
}

fn spin(pose: Pose2, heading_rad: f32, pace: &Pace) -> Tracking {
    let error_rad = wrap_angle(heading_rad - pose.heading_rad);
    if error_rad.abs() < AIMED_RAD {
        return Tracking::Arrived;
    }
    let rate_radps = (1.5 * error_rad.abs()).clamp(CRAWL.1, pace.turn_radps);
    Tracking::Drive(Twist2 { linear_mps: 0.0, angular_radps: rate_radps.copysign(error_rad) })
}

/// Where on a piece the robot is.
struct Foot {
    /// Leg of the piece, from 0.
    leg: usize,
    /// Metres along that leg.
    along_m: f32,
    /// Distance left to the end of the piece, metres; negative beyond the end.
    left_m: f32,
    /// Distance from the piece, metres.
    off_m: f32,
}

fn place(waypoint: &Waypoint) -> Point2 {
    Point2::new(waypoint.pose.x_m, waypoint.pose.y_m)
}

/// The nearest point of the legs, from the one where the robot was on, and only of the next few: a path may cross
/// itself. On the last one the robot may be beyond the end.
fn foot_of(points: &[Waypoint], (here, was_on): (Point2, usize)) -> Option<Foot> {
    let lengths: Vec<f32> = points.windows(2).map(|leg| place(&leg[0]).distance(place(&leg[1]))).collect();
    let mut best: Option<Foot> = None;
    let mut left_m: f32 = lengths.iter().sum();
    for (leg, (ends, &length_m)) in points.windows(2).zip(&lengths).enumerate() {
        let (from, to) = (place(&ends[0]), place(&ends[1]));
        let (ux, uy) = ((to.x_m - from.x_m) / length_m.max(1e-6), (to.y_m - from.y_m) / length_m.max(1e-6));
        let along_m = (here.x_m - from.x_m) * ux + (here.y_m - from.y_m) * uy;
        let is_last = leg + 1 == lengths.len();
        let held_m = along_m.clamp(0.0, if is_last { f32::MAX } else { length_m });
        let off_m = here.distance(Point2::new(from.x_m + held_m * ux, from.y_m + held_m * uy));
        let is_next = (was_on..was_on + LEGS_AHEAD).contains(&leg);
        if is_next && best.as_ref().is_none_or(|best| off_m <= best.off_m) {
            best = Some(Foot { leg, along_m: held_m, left_m: left_m - held_m, off_m });
        }
        left_m -= length_m;
    }
    best
}

/// The point of the piece that lies ahead of the foot; beyond the end the last leg goes on straight.
fn aim_of(points: &[Waypoint], foot: &Foot, ahead_m: f32) -> Point2 {
    let mut ahead_m = foot.along_m + ahead_m;
    let legs = points.windows(2).skip(foot.leg);
    let count = legs.len();
    for (number, leg) in legs.enumerate() {
        let (from, to) = (place(&leg[0]), place(&leg[1]));
        let length_m = from.distance(to);
        if ahead_m <= length_m || number + 1 == count {
            let t = ahead_m / length_m.max(1.0e-6);
            return Point2::new(from.x_m + t * (to.x_m - from.x_m), from.y_m + t * (to.y_m - from.y_m));
        }
        ahead_m -= length_m;
    }
    points.last().map_or(Point2::default(), place)
}

#[cfg(test)]
mod tests {
    use super::*;

    const PACE: Pace = Pace { speed_mps: 0.5, turn_radps: 0.6, reverse_mps: 0.2, change_s: 1.0 };

    fn at(x_m: f32, y_m: f32, heading_rad: f32, gear: Gear) -> Waypoint {
        Waypoint { pose: Pose2::new(x_m, y_m, heading_rad), gear }
    }

    #[test]
    fn drives_ahead_turns_and_backs_up() {
        let quarter = std::f32::consts::FRAC_PI_2;
        let path = vec![
            at(0.0, 0.0, 0.0, Gear::Ahead),
            at(1.0, 0.0, 0.0, Gear::Ahead),
            at(2.0, 0.0, 0.0, Gear::Ahead),
            at(2.0, 0.0, quarter, Gear::Spin),
            at(2.0, 1.0, quarter, Gear::Ahead),
            at(2.0, 0.5, quarter, Gear::Back),
        ];
        let mut track = Track::new(path);
        let mut pose = Pose2::new(0.0, 0.1, 0.1);
        let mut farthest_m = 0.0_f32;
        for _ in 0..1_000 {
            let Tracking::Drive(twist) = track.follow(pose, &PACE) else { break };
            assert!(twist.linear_mps.abs() <= 0.5 && twist.angular_radps.abs() <= 0.6 + 1e-5);
            let step = Pose2::new(twist.linear_mps * 0.05, 0.0, twist.angular_radps * 0.05);
            pose = pose.compose(step);
            farthest_m = farthest_m.max(pose.y_m);
        }
        assert!(track.is_over());
        assert!(farthest_m > 0.9, "{farthest_m}");
        assert!((pose.y_m - 0.5).abs() < 0.1 && (pose.x_m - 2.0).abs() < 0.15, "{pose:?}");
        let mut lost = Track::new(vec![at(0.0, 0.0, 0.0, Gear::Ahead), at(2.0, 0.0, 0.0, Gear::Ahead)]);
        assert_eq!(lost.follow(Pose2::new(1.0, 0.6, 0.0), &PACE), Tracking::Lost);
    }
}
