//! Times to people against robots and people that walk in steps of a millisecond, in 64 bits.

use super::fixtures::config;
use crate::*;
use floorguard_types::geometry::{Point2, Twist2};
use floorguard_types::random::Pcg32;

const STEP_S: f64 = 1.0e-3;

/// From the nearest point of the body's box to a point.
fn from_body(body: &Body, (x, y): (f64, f64)) -> (f64, f64) {
    let [[x0, x1], [y0, y1]] = [body.x_m, body.y_m].map(|pair| pair.map(f64::from));
    (x - x.clamp(x0, x1), y - y.clamp(y0, y1))
}

fn distance(body: &Body, at: (f64, f64)) -> f64 {
    let (x, y) = from_body(body, at);
    x.hypot(y)
}

/// The first of some moments at which somebody is within a radius and comes nearer, or touches the body from the start.
fn first_touch(times_s: impl Iterator<Item = f64>, gap_m: impl Fn(f64) -> f64, radius_m: f64) -> f64 {
    if gap_m(0.0) < 0.3 {
        return 0.0;
    }
    let nearer = |time_s: f64, by_s: f64| gap_m(time_s + by_s) < gap_m(time_s);
    let mut times_s = times_s.map(|time_s| (time_s, time_s == 0.0 || nearer(time_s - STEP_S, STEP_S)));
    let touch = times_s.find(|(time_s, came)| {
        gap_m(*time_s) <= radius_m && (nearer(*time_s, STEP_S) || (*came && *time_s > 0.0))
    });
    touch.map_or(f64::INFINITY, |(time_s, _)| time_s)
}

/// A straight robot and a person; the person walks towards the body faster by the doubt. Seconds, up to 10.
fn walked_s(body: &Body, person: &AdvisedPerson, speed_mps: f64, doubt_mps: f64) -> f64 {
    let radius_m = 0.3 + 2.0 * f64::from(person.position_sigma_m);
    let start = (f64::from(person.position.x_m), f64::from(person.position.y_m));
    let velocity = (f64::from(person.velocity_mps.x_m), f64::from(person.velocity_mps.y_m));
    let (from, gap) = (from_body(body, start), distance(body, start));
    let share = doubt_mps / gap.max(1.0e-9);
    let closing = (velocity.0 - speed_mps - share * from.0, velocity.1 - share * from.1);
    let gap_m = |time_s: f64| distance(body, (start.0 + closing.0 * time_s, start.1 + closing.1 * time_s));
    first_touch((0..10_000).map(|step| f64::from(step) * STEP_S), gap_m, radius_m)
}

fn person(random: &mut Pcg32) -> AdvisedPerson {
    let mut between = |low: f32, high: f32| low + (high - low) * random.below(10_001) as f32 * 1.0e-4;
    AdvisedPerson {
        position: Point2::new(between(-4.0, 5.0), between(-4.0, 4.0)),
        velocity_mps: Point2::new(between(-1.5, 1.5), between(-1.5, 1.5)),
        position_sigma_m: between(0.0, 0.2),
        velocity_sigma_mps: between(0.0, 0.4),
        ..AdvisedPerson::default()
    }
}

/// Equal, or both beyond the horizon: a graze may be found or missed by a step.
fn agree(found_s: f32, walked_s: f64) -> bool {
    let found_s = f64::from(found_s);
    (found_s - walked_s).abs() < 5.0 * STEP_S || (found_s > 9.9 && walked_s > 9.9)
}

#[test]
fn fg_req_031_straight_times_are_those_of_people_who_walk() {
    let bodies = [Body::around(&config().footprint), Body { x_m: [-0.3, 1.2], y_m: [-0.2, 0.6] }];
    let mut random = Pcg32::new(21, 1);
    let (mut finite, mut grazes) = (0, 0);
    for round in 0..600_u32 {
        let (body, person) = (&bodies[(round % 2) as usize], person(&mut random));
        let speed_mps = [0.0, 0.3, 0.8, -0.3][(round % 4) as usize];
        let twist = Twist2 { linear_mps: speed_mps, angular_radps: 0.05 };
        let [estimated_s, doubtful_s] = body.times_to_person_s(&person, twist);
        let doubt = f64::from(person.velocity_sigma_mps);
        let walked = [0.0, doubt].map(|doubt| walked_s(body, &person, f64::from(speed_mps), doubt));
        let walked = [walked[0], walked[1].min(walked[0])];
        let good = agree(estimated_s, walked[0]) && agree(doubtful_s, walked[1]);
        grazes += u32::from(!good);
        finite += u32::from(estimated_s.is_finite() && estimated_s > 0.0);
        assert!(doubtful_s <= estimated_s);
    }
    assert!(finite > 60 && grazes < 4, "{finite} meet, {grazes} differ");
}

/// Where a turning robot is after a time, by very small steps.
fn robot_after(twist: Twist2, time_s: f64) -> (f64, f64, f64) {
    let (mut x, mut y, mut heading) = (0.0_f64, 0.0_f64, 0.0_f64);
    let step_s = time_s / 500.0;
    for _ in 0..500 {
        let middle = heading + f64::from(twist.angular_radps) * 0.5 * step_s;
        x += f64::from(twist.linear_mps) * step_s * middle.cos();
        y += f64::from(twist.linear_mps) * step_s * middle.sin();
        heading += f64::from(twist.angular_radps) * step_s;
    }
    (x, y, heading)
}

/// Whole tenths of a second are examined, and whether the person is nearer at the next or was farther at the last.
fn turned_s(body: &Body, person: &AdvisedPerson, twist: Twist2, growth_mps: f64) -> f64 {
    let radius_m = 0.3 + 2.0 * f64::from(person.position_sigma_m);
    let gaps: std::vec::Vec<f64> = (0..=31_u32)
        .map(|step| {
            let time_s = f64::from(step) * 0.1;
            let (x, y, heading) = robot_after(twist, time_s);
            let ahead = (
                f64::from(person.position.x_m) + f64::from(person.velocity_mps.x_m) * time_s - x,
                f64::from(person.position.y_m) + f64::from(person.velocity_mps.y_m) * time_s - y,
            );
            let (sin, cos) = heading.sin_cos();
            let in_robot = (cos * ahead.0 + sin * ahead.1, cos * ahead.1 - sin * ahead.0);
            distance(body, in_robot) - growth_mps * time_s
        })
        .collect();
    if gaps[0] < 0.3 {
        return 0.0;
    }
    let comes = |step: usize| gaps[step + 1] < gaps[step] || (step > 0 && gaps[step] < gaps[step - 1]);
    let touch = (0..=30).find(|step| gaps[*step] <= radius_m && comes(*step));
    touch.map_or(f64::INFINITY, |step| step as f64 * 0.1)
}

#[test]
fn fg_req_031_turning_robots_have_turning_times() {
    let body = Body { x_m: [-0.3, 1.2], y_m: [-0.2, 0.6] };
    let mut random = Pcg32::new(22, 1);
    let (mut finite, mut grazes) = (0, 0);
    for round in 0..400_u32 {
        let person = person(&mut random);
        let angular_radps = [0.051, 0.3, -0.6, -0.06][(round % 4) as usize];
        let twist = Twist2 { linear_mps: [0.8, 0.3, -0.3][(round % 3) as usize], angular_radps };
        let found = body.times_to_person_s(&person, twist);
        let turned = [0.0, f64::from(person.velocity_sigma_mps)]
            .map(|growth_mps| turned_s(&body, &person, twist, growth_mps));
        let good = found.into_iter().zip(turned).all(|(found_s, turned_s)| {
            (f64::from(found_s) - turned_s).abs() < 1.0e-3
                || (found_s.is_infinite() && turned_s.is_infinite())
        });
        grazes += u32::from(!good);
        finite += u32::from(found[0].is_finite() && found[0] > 0.0);
    }
    assert!(finite > 40 && grazes < 3, "{finite} meet, {grazes} differ");
}

#[test]
fn fg_req_031_tangent_person_is_within_standing_never_arrives() {
    let time =
        |p: (f32, f32), u: (f32, f32)| time_to_collision_s(Point2::new(p.0, p.1), Point2::new(u.0, u.1), 1.0);
    assert_eq!(time((1.0, 0.0), (0.0, 0.0)), 0.0);
    assert_eq!(time((1.0, 0.0), (5.0, 0.0)), 0.0);
    assert_eq!(time((3.0, 1.0), (-1.0, 0.0)), 3.0, "a tangent");
    assert!(time((3.0, 0.0), (0.0, 1.0)).is_infinite(), "across, never nearer");
    assert!(time((3.0, 0.0), (-0.9e-3, 0.0)).is_infinite() && time((3.0, 0.0), (-1.1e-3, 0.0)).is_finite());
    // Exactly a millimetre per second counts as motion.
    let numbers = core::iter::successors(Some(7.99e-4_f32), |y| Some(y.next_up())).take(100_000);
    let across = numbers.into_iter().find(|y| 6.0e-4_f32 * 6.0e-4 + y * y == 1.0e-6).expect("a number");
    assert!(time((3.0, 4.0), (-6.0e-4, -across)).is_finite());
}

#[test]
fn fg_req_031_distances_are_those_to_the_box() {
    let body = Body { x_m: [-0.5, 1.0], y_m: [-0.25, 0.75] };
    let cases = [
        ((2.0, 0.0), 1.0),
        ((-1.5, 0.0), 1.0),
        ((0.0, 1.75), 1.0),
        ((0.0, -1.25), 1.0),
        ((4.0, 4.75), 5.0),
        ((-3.5, -4.25), 5.0),
        ((0.9, 0.7), 0.0),
        ((1.0, 0.75), 0.0),
    ];
    for ((x_m, y_m), expected_m) in cases {
        assert_eq!(body.distance_m(Point2::new(x_m, y_m)), expected_m, "{x_m} {y_m}");
    }
    let corners = [(1.0, 0.75), (-0.5, 0.1), (0.2, -0.25)].map(|(x_m, y_m)| Point2::new(x_m, y_m));
    assert_eq!(Body::around(&corners), body);
}
