//! Random encounters: 1 to 10 people cross the robot's path at 0 to 2 m/s without looking.

use floorguard_types::geometry::{Point2, Pose2};
use floorguard_types::random::Pcg32;

use crate::people::{Build, Person, PersonKind};

const KINDS: [PersonKind; 8] = [
    PersonKind::Adult,
    PersonKind::Adult,
    PersonKind::Adult,
    PersonKind::Child,
    PersonKind::Wheelchair,
    PersonKind::Crouching,
    PersonKind::Trolley,
    PersonKind::Luggage,
];

/// Adds the people. Nobody begins within 2.5 m of the robot's start.
pub fn add_people(start: Pose2, people: &mut Vec<Person>, random: &mut Pcg32) {
    for _ in 0..1 + random.below(10) {
        let kind = KINDS[random.below(KINDS.len() as u32) as usize];
        let meeting = start.transform(Point2::new(random.uniform_between(3.0, 14.0), 0.0));
        let angle = random.uniform_between(0.0, core::f32::consts::TAU);
        let far_m = random.uniform_between(3.0, 9.0);
        let (sin, cos) = libm::sincosf(angle);
        let mut position = Point2::new(meeting.x_m + far_m * cos, meeting.y_m + far_m * sin);
        if position.distance(Point2::new(start.x_m, start.y_m)) < 2.5 {
            position = Point2::new(meeting.x_m, meeting.y_m + 4.0);
        }
        let across = Point2::new(2.0 * meeting.x_m - position.x_m, 2.0 * meeting.y_m - position.y_m);
        let moves = kind != PersonKind::Crouching && random.bernoulli(0.85);
        people.push(Person {
            id: people.len() as u32 + 1,
            kind,
            build: Build::SAME,
            position,
            velocity: Point2::default(),
            heading_rad: angle,
            gait_rad: random.uniform_between(0.0, 6.0),
            goals: vec![across, position],
            goal: 0,
            speed_mps: if moves { random.uniform_between(0.2, 2.0) } else { 0.0 },
            starts_us: u64::from(random.below(8_000)) * 1_000 + 3_000_000,
            sees_robot: random.bernoulli(0.5),
            walk: None,
        });
    }
}
