//! The judge against brute force: points sampled in objects and in the robot, moments sampled on the way.

mod common;

use common::{body, drive, no_people, setup};
use floorguard_contact_judge::{RobotBody, RobotMotion, RobotPose, Solid, Surface, Thing, ThingKind};
use proptest::prelude::*;

/// Every so far a point is sampled, metres.
const GRID_M: f32 = 0.02;

/// Points on the faces of a box, on a grid that has its corners; the robot is never within a box.
fn points(solid: &Solid) -> Vec<[f32; 3]> {
    let Solid::Box { centre_m, half_m, yaw_rad, .. } = *solid else { panic!("a box") };
    let (sin, cos) = yaw_rad.sin_cos();
    let steps = half_m.map(|half| (2.0 * half / GRID_M).ceil().max(1.0) as u16);
    let at = |axis: usize, step: u16| half_m[axis] * (2.0 * f32::from(step) / f32::from(steps[axis]) - 1.0);
    let mut all = Vec::new();
    for i in 0..=steps[0] {
        for j in 0..=steps[1] {
            for k in 0..=steps[2] {
                let is_face = [i, j, k].iter().zip(steps).any(|(at, last)| *at == 0 || *at == last);
                if !is_face {
                    continue;
                }
                let [x, y, z] = [at(0, i), at(1, j), at(2, k)];
                all.push([centre_m[0] + cos * x - sin * y, centre_m[1] + sin * x + cos * y, centre_m[2] + z]);
            }
        }
    }
    all
}

/// Distance of a point from the robot's boxes, metres; 0 within.
fn distance_m(pose: RobotPose, point: [f32; 3]) -> f32 {
    let (sin, cos) = pose.heading_rad.sin_cos();
    let (dx, dy) = (point[0] - pose.x_m, point[1] - pose.y_m);
    let (x, y) = (cos * dx + sin * dy, cos * dy - sin * dx);
    let outside = |value: f32, low: f32, high: f32| (low - value).max(value - high).max(0.0);
    let of_part = |part: &floorguard_contact_judge::BodyPart| {
        let [low, high] = [part.outline_m[0], part.outline_m[2]];
        let off = [
            outside(x, low[0], high[0]),
            outside(y, low[1], high[1]),
            outside(point[2], part.height_m[0], part.height_m[1]),
        ];
        off.iter().map(|value| value * value).sum::<f32>().sqrt()
    };
    body().iter().map(of_part).fold(f32::MAX, f32::min)
}

fn sampled_m(pose: RobotPose, points: &[[f32; 3]]) -> f32 {
    points.iter().map(|point| distance_m(pose, *point)).fold(f32::MAX, f32::min)
}

fn any_box() -> impl Strategy<Value = Solid> {
    let place = (-2.0..2.5_f32, -2.0..2.0_f32, 0.0..0.9_f32);
    let half = (0.015..0.2_f32, 0.015..0.2_f32, 0.015..0.2_f32);
    (place, half, -3.1..3.1_f32).prop_map(|((x, y, z), (a, b, c), yaw_rad)| Solid::Box {
        centre_m: [x, y, z + c],
        half_m: [a, b, c],
        yaw_rad,
        slope_rad: 0.0,
    })
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 200, ..ProptestConfig::default() })]

    /// Gap and touch agree with the samples within a grid's diagonal.
    #[test]
    fn gaps_agree_with_sampled_points(solid in any_box(), heading_rad in -3.1..3.1_f32, x_m in -0.5..0.5_f32) {
        let pose = RobotPose { x_m, y_m: 0.0, heading_rad };
        let gap_m = RobotBody::new(&body()).unwrap().nearest(pose, &solid).gap_m;
        let sampled = sampled_m(pose, &points(&solid));
        // The library's search ends once it is within 0.11 % of the distance, the root of ten times the precision of its numbers: 2 mm
        // at 2 m, and nothing where bodies touch.
        prop_assert!(gap_m.max(0.0) <= sampled * 1.001_1 + 1e-3, "{gap_m} against {sampled}");
        prop_assert!(sampled <= gap_m.max(0.0) + GRID_M, "{gap_m} against {sampled}");
        if sampled <= 0.0 {
            prop_assert!(gap_m <= 1e-4, "{gap_m} against {sampled}");
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 40, ..ProptestConfig::default() })]

    /// The moment of a contact on any curve agrees with the first of many sampled moments.
    #[test]
    fn moments_agree_with_sampled_ways(
        solid in any_box(),
        forward_mps in prop_oneof![-0.3..-0.02_f32, 0.02..1.0_f32, Just(0.0_f32)],
        turn_radps in -0.8..0.8_f32,
    ) {
        let cloud = points(&solid);
        let motion = RobotMotion { forward_mps, turn_radps };
        prop_assume!(sampled_m(RobotPose::default(), &cloud) > 0.03);
        let thing = Thing {
            name: "box".into(),
            kind: ThingKind::Solid,
            solid,
            surface: Surface::Opaque,
            from_s: 0.0,
        };
        let mut plan = setup(vec![thing]);
        // Who could have seen it is not the question here.
        plan.sensors.clear();
        let report = drive(plan, 3.0, |_| motion, no_people);
        let sampled = |at_s: f32| sampled_m(RobotPose::default().after(motion, at_s), &cloud);
        let moments = || (0..300_u16).map(|step| f32::from(step) * 0.01);
        let first_s = moments().find(|at_s| sampled(*at_s) <= 0.0);
        match (first_s, report.contacts.first()) {
            // Samples see a contact at most a grid later than it is.
            (Some(first_s), Some(contact)) => {
                prop_assert!(contact.at_s as f32 <= first_s + 0.011, "{contact:?} against {first_s}");
                prop_assert!(sampled(contact.at_s as f32) <= GRID_M + 0.012, "{contact:?}");
            }
            (Some(first_s), None) => prop_assert!(first_s > 2.98, "the judge saw nothing, samples did at {first_s}"),
            (None, Some(contact)) => {
                prop_assert!(sampled(contact.at_s as f32) <= GRID_M + 0.012, "{contact:?}");
            }
            (None, None) => {}
        }
    }
}
