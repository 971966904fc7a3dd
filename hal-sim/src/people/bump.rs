//! Nobody walks through the robot: who bumps into its body slides along it.

use floorguard_types::geometry::{Point2, Pose2};

use super::{Person, body_discs};
use crate::scene::distance_to_area;

/// A body may press this deep into the outline, metres: touching stays a contact for judges.
const PRESS_M: f32 = 0.01;
/// Of displacements, metres.
const ROUNDING_M: f32 = 0.005;
/// Nobody slides farther in one step, metres: the robot and the person walk some centimetres in it.
const SLIDE_M: f32 = 0.06;

/// The robot as people see it and bump into it.
#[derive(Clone, Copy, Debug)]
pub struct RobotShape<'a> {
    /// World frame.
    pub pose: Pose2,
    /// Outline, robot frame, metres.
    pub outline: &'a [Point2],
    /// Middle of the disc that people walk around, robot frame, and its radius, metres.
    pub seen_as: (Point2, f32),
}

impl RobotShape<'_> {
    /// From a place to the outline, metres; 0 within it.
    pub fn gap_m(&self, place: Point2) -> f32 {
        let in_robot = self.pose.inverse().transform(place);
        distance_to_area(self.outline, in_robot)
    }
}

/// Where a person stands and looks.
#[derive(Clone, Copy, Debug)]
pub struct Stance {
    position: Point2,
    heading_rad: f32,
}

impl Stance {
    pub fn of(person: &Person) -> Self {
        Self { position: person.position, heading_rad: person.heading_rad }
    }
}

/// Keeps a person who walked a step out of the robot: a turn that would bring a part into it (a trolley) is not made, the
/// rest slides along it, and where that does not help, the person stays where it was.
pub fn keep_out(person: &mut Person, before: Stance, robot: &RobotShape<'_>) {
    let deep_m = depth_m(person, robot);
    if deep_m <= 0.0 {
        return;
    }
    let walked = Stance::of(person);
    person.heading_rad = before.heading_rad;
    if depth_m(person, robot) >= deep_m {
        person.heading_rad = walked.heading_rad;
    }
    slide_off(person, robot);
    let slid = Stance::of(person);
    let deep_m = depth_m(person, robot);
    if deep_m <= PRESS_M + ROUNDING_M && slid.position.distance(walked.position) < SLIDE_M {
        return;
    }
    (person.position, person.heading_rad) = (before.position, before.heading_rad);
    if depth_m(person, robot) > deep_m {
        // The robot came nearer meanwhile.
        (person.position, person.heading_rad) = (slid.position, slid.heading_rad);
        return;
    }
    person.velocity = Point2::default();
}

/// How deep a person is in the outline of the robot, metres.
fn depth_m(person: &Person, robot: &RobotShape<'_>) -> f32 {
    let to_robot = robot.pose.inverse();
    let depth_m = |(middle, radius_m)| {
        push_out(robot.outline, to_robot.transform(middle), radius_m).map_or(0.0, |push| push.norm())
    };
    body_discs(person).into_iter().map(depth_m).fold(0.0, f32::max)
}

/// Puts a person who walks beside the robot, and takes away the speed towards it. Who has bumped into it has noticed it.
fn slide_off(person: &mut Person, robot: &RobotShape<'_>) {
    let to_robot = robot.pose.inverse();
    for (middle, radius_m) in body_discs(person) {
        let Some(push) = push_out(robot.outline, to_robot.transform(middle), radius_m - PRESS_M) else {
            continue;
        };
        let turn = Pose2::new(0.0, 0.0, robot.pose.heading_rad);
        let push = turn.transform(push);
        let length_m = push.norm().max(1.0e-6);
        person.sees_robot = true;
        person.position.x_m += push.x_m;
        person.position.y_m += push.y_m;
        let inward_mps = -(person.velocity.x_m * push.x_m + person.velocity.y_m * push.y_m) / length_m;
        if inward_mps > 0.0 {
            person.velocity.x_m += inward_mps * push.x_m / length_m;
            person.velocity.y_m += inward_mps * push.y_m / length_m;
        }
        return;
    }
}

/// The shortest displacement that takes a disc out of an outline; `None` when it is out already.
fn push_out(outline: &[Point2], middle: Point2, radius_m: f32) -> Option<Point2> {
    let mut nearest: Option<(f32, Point2)> = None;
    let mut inside = false;
    for (a, b) in outline.iter().zip(outline.iter().cycle().skip(1)) {
        let (dx, dy) = (b.x_m - a.x_m, b.y_m - a.y_m);
        let along = ((middle.x_m - a.x_m) * dx + (middle.y_m - a.y_m) * dy) / (dx * dx + dy * dy).max(1.0e-9);
        let along = along.clamp(0.0, 1.0);
        let foot = Point2::new(a.x_m + along * dx, a.y_m + along * dy);
        let distance_m = middle.distance(foot);
        if nearest.is_none_or(|(best_m, _)| distance_m < best_m) {
            nearest = Some((distance_m, foot));
        }
        let crosses = (a.y_m > middle.y_m) != (b.y_m > middle.y_m);
        if crosses && middle.x_m < a.x_m + (middle.y_m - a.y_m) / dy * dx {
            inside = !inside;
        }
    }
    let (distance_m, foot) = nearest?;
    let deep_m = if inside { radius_m + distance_m } else { radius_m - distance_m };
    if deep_m <= 0.0 || distance_m < 1.0e-6 {
        return None;
    }
    let scale = if inside { -deep_m } else { deep_m } / distance_m;
    Some(Point2::new((middle.x_m - foot.x_m) * scale, (middle.y_m - foot.y_m) * scale))
}

#[cfg(test)]
mod tests {
    use super::super::{Build, Crowd, PersonKind};
    use super::*;
    use crate::robot::RobotParameters;
    use crate::scene::SceneBuilder;

    fn walker(kind: PersonKind, from: Point2, goal: Point2) -> Person {
        Person {
            id: 1,
            kind,
            build: Build::SAME,
            position: from,
            velocity: Point2::default(),
            heading_rad: 0.0,
            gait_rad: 0.0,
            goals: vec![goal],
            goal: 0,
            speed_mps: 1.5,
            starts_us: 0,
            sees_robot: false,
            walk: None,
        }
    }

    /// An inattentive person walks straight at a robot that stands, from every side.
    #[test]
    fn no_person_enters_robot_most_pass() {
        let robot = RobotParameters::default();
        let scene = SceneBuilder::default().build();
        let shape = RobotShape {
            pose: Pose2::new(1.0, 2.0, 0.4),
            outline: &robot.footprint,
            seen_as: (Point2::new(0.25, 0.0), 0.85),
        };
        // Distance from the outline, a rectangle, to the middle of the body.
        let gap_m = |person: &Person| {
            let place = shape.pose.inverse().transform(person.position);
            ((place.x_m - 0.25).abs() - 0.7).max(0.0).hypot((place.y_m.abs() - 0.4).max(0.0))
        };
        let mut past = 0;
        for kind in [PersonKind::Adult, PersonKind::Child, PersonKind::Trolley, PersonKind::Wheelchair] {
            for side in 0..12 {
                let angle = side as f32 * 0.523 + 0.1;
                let at =
                    |path_m: f32| Point2::new(1.25 + path_m * angle.cos(), 2.1 + path_m * angle.sin() + 0.13);
                let mut crowd = Crowd::new(vec![walker(kind, at(-4.0), at(4.0))]);
                let mut arrived = false;
                for step in 0..1_500_u64 {
                    crowd.step(step * 10_000, 0.01, &scene, &shape);
                    let person = &crowd.people[0];
                    let deep_m = kind.radius_m() - gap_m(person);
                    assert!(deep_m < 0.04, "{kind:?} from {angle} is {deep_m} m in the robot");
                    let deep_m = depth_m(person, &shape);
                    assert!(deep_m < 0.06, "{kind:?} from {angle} is with a part {deep_m} m in the robot");
                    arrived |= person.position.distance(at(4.0)) < 0.7;
                }
                past += u32::from(arrived);
            }
        }
        // Forces balance here and there, and somebody stands before the robot for a while; nobody goes through it.
        assert!(past >= 36, "{past} of 48 got past");
    }

    /// A person with a trolley, who turns round before the nose of the robot.
    #[test]
    fn turning_trolley_stays_out_of_robot() {
        let robot = RobotParameters::default();
        let scene = SceneBuilder::default().build();
        let shape = RobotShape {
            pose: Pose2::default(),
            outline: &robot.footprint,
            seen_as: (Point2::new(0.25, 0.0), 0.85),
        };
        for start in [(1.4, 0.0), (1.3, 0.3), (0.4, 0.75), (-0.9, 0.2)] {
            let from = Point2::new(start.0, start.1);
            let mut person = walker(PersonKind::Trolley, from, Point2::new(-4.0 * start.0, -4.0 * start.1));
            person.heading_rad = start.1.atan2(start.0 - 0.25);
            person.velocity = Point2::new(0.2 * person.heading_rad.cos(), 0.2 * person.heading_rad.sin());
            let mut crowd = Crowd::new(vec![person]);
            for step in 0..500_u64 {
                let before = crowd.people[0].position;
                crowd.step(step * 10_000, 0.01, &scene, &shape);
                let person = &crowd.people[0];
                let (deep_m, moved_m) = (depth_m(person, &shape), person.position.distance(before));
                assert!(deep_m < 0.06, "from {start:?}, step {step}: {deep_m} m in the robot");
                assert!(moved_m < 0.1, "from {start:?}, step {step}: moved by {moved_m} m at once");
            }
        }
    }
}
