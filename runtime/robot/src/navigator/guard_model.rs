//! What the guard would do, as far as people are concerned: a planner that knows it does not ask for what is refused.
//!
//! The rules are the guard's (book, Guard: Collision): somebody near limits the speed, and nobody may be reached sooner than the
//! robot can stand. People are where they will be by then. An answer is a forecast; the guard decides.

use floorguard_guard::{AdvisedPerson, Body, DriveLimits, Thresholds, fastest_mps};
use floorguard_runtime::configuration::RobotConfiguration;
use floorguard_types::geometry::{Point2, Pose2, Twist2};
use floorguard_types::motion::{MovingPerson, Permission, PermittedMotion, PlannedMotion};

use super::model::PERSON_RADIUS_M;

/// People that count; the nearest ones.
const PEOPLE_MAX: usize = 6;
/// Farther away a person changes nothing within three seconds, metres.
const REACH_M: f32 = 6.0;
/// Two of these are added to a person's radius; more doubt than this makes nobody larger, metres.
const DEVIATION_MAX_M: f32 = 0.15;
/// How long a stop for a person holds the robot: until two lists show that the person diverges, or a second after the last evidence, and what
/// the guard sees of it late, seconds.
const HELD_S: f32 = 1.0;
/// From this speed on the guard judges people by what the robot does; below by a slow start of what it requests, m/s.
const STARTED_MPS: f32 = 0.05;

/// The rules, and who is near.
#[derive(Clone, Debug)]
pub struct GuardModel {
    body: Body,
    drive: DriveLimits,
    thresholds: Thresholds,
    outline: Vec<Point2>,
    people: Vec<MovingPerson>,
}

impl GuardModel {
    /// Of a robot with nobody around.
    #[must_use]
    pub fn of(robot: &RobotConfiguration) -> Self {
        Self {
            body: Body::around(&robot.geometry.footprint),
            drive: robot.guard().drive,
            thresholds: robot.thresholds,
            outline: robot.geometry.footprint.to_vec(),
            people: Vec::new(),
        }
    }

    /// These people are known now.
    pub fn meet(&mut self, people: &[MovingPerson], here: Point2) {
        self.people.clear();
        self.people.extend(people.iter().filter(|person| person.position_in_map.distance(here) < REACH_M));
        let distance_m = |person: &MovingPerson| person.position_in_map.distance(here);
        self.people.sort_by(|a, b| distance_m(a).total_cmp(&distance_m(b)));
        self.people.truncate(PEOPLE_MAX);
    }

    /// The motion by which the guard judges people.
    fn judged(&self, twist: Twist2) -> Twist2 {
        let speed_mps = twist.linear_mps.abs();
        if speed_mps > STARTED_MPS {
            return twist;
        }
        let times = self.thresholds.person_speed_mps / speed_mps.max(1.0e-3);
        Twist2 { linear_mps: twist.linear_mps * times, angular_radps: twist.angular_radps * times }
    }
}

impl PermittedMotion for GuardModel {
    /// Cost: a few products a person, six people at most.
    fn permission(&self, motion: PlannedMotion) -> Permission {
        let mut permission = Permission::FREE;
        if self.people.is_empty() || motion.twist.linear_mps.abs() < 0.02 {
            return permission;
        }
        let twist = self.judged(motion.twist);
        let pose = motion.pose_in_map;
        let (sin, cos) = libm::sincosf(pose.heading_rad);
        let turned = |x_m: f32, y_m: f32| Point2::new(cos * x_m + sin * y_m, cos * y_m - sin * x_m);
        let clear_s = self.drive.clear_of_people_s(twist.linear_mps.abs());
        // Limits hold for the fastest point of the body.
        let fastest_mps = fastest_mps(&self.outline, motion.twist).max(1.0e-3);
        let near_share = (self.thresholds.person_speed_mps / fastest_mps).min(1.0);
        for person in &self.people {
            let velocity = person.velocity_in_map_mps;
            let then = Point2::new(
                person.position_in_map.x_m + velocity.x_m * motion.in_s,
                person.position_in_map.y_m + velocity.y_m * motion.in_s,
            );
            let in_base = turned(then.x_m - pose.x_m, then.y_m - pose.y_m);
            let gap_m = self.body.distance_m(in_base);
            let velocity_mps = turned(velocity.x_m, velocity.y_m);
            let position_sigma_m = person.position_deviation_m.min(DEVIATION_MAX_M);
            let advised = AdvisedPerson {
                position: in_base,
                velocity_mps,
                position_sigma_m,
                ..AdvisedPerson::default()
            };
            if gap_m < self.thresholds.person_near_m && !self.body.is_exempt_from_near_limit(&advised, twist)
            {
                permission.share = permission.share.min(near_share);
            }
            let relative = Point2::new(velocity_mps.x_m - twist.linear_mps, velocity_mps.y_m);
            let radius_m = PERSON_RADIUS_M + 2.0 * position_sigma_m;
            // Nobody is reached who is farther away than the way of that time: most people, and the cheapest question.
            if gap_m > radius_m + relative.norm() * clear_s {
                continue;
            }
            let comes_near = comes_near(&self.body, (in_base, relative), (gap_m, radius_m, clear_s));
            if comes_near && !self.body.recedes_from(&advised, twist) {
                return Permission::stop(HELD_S);
            }
        }
        permission
    }
}

/// At a constant relative velocity the body, now `gap_m` away, would come nearer to a person than a radius within a time.
fn comes_near(
    body: &Body,
    (place, relative): (Point2, Point2),
    (gap_m, radius_m, within_s): (f32, f32, f32),
) -> bool {
    let after = |time_s: f32| {
        body.distance_m(Point2::new(place.x_m + time_s * relative.x_m, place.y_m + time_s * relative.y_m))
    };
    [0.33, 0.66, 1.0]
        .into_iter()
        .map(|share| after(share * within_s))
        .any(|then_m| then_m < radius_m && then_m < gap_m - 0.02)
}

/// The place of a pose.
pub(super) const fn place_of(pose: Pose2) -> Point2 {
    Point2::new(pose.x_m, pose.y_m)
}
