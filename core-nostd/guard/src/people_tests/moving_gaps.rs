//! Nobody is left out who could be reached: receding robots against people who may stand anywhere within the doubt.

use proptest::prelude::*;

use crate::{AdvisedPerson, Body};
use floorguard_types::geometry::{Point2, Pose2, Twist2};
use std::vec::Vec;

/// The axle of a robot of 1.4 m by 0.8 m lies 0.45 m before its rear.
const BODY: Body = Body { x_m: [-0.45, 0.95], y_m: [-0.4, 0.4] };

fn seen(place: (f32, f32), velocity: (f32, f32)) -> AdvisedPerson {
    AdvisedPerson {
        id: 1,
        position: Point2::new(place.0, place.1),
        velocity_mps: Point2::new(velocity.0, velocity.1),
        position_sigma_m: 0.05,
        velocity_sigma_mps: 0.1,
    }
}

/// Gaps of a turning robot to a person who stands, every 0.05 s for 1.5 s: longer than it needs to stop.
fn gaps_m(person: Point2, twist: Twist2) -> Vec<f32> {
    let (mut pose, mut gaps_m) = (Pose2::default(), std::vec![BODY.distance_m(person)]);
    for _ in 0..30 {
        pose = pose.compose(Pose2::new(twist.linear_mps * 0.05, 0.0, twist.angular_radps * 0.05));
        gaps_m.push(BODY.distance_m(pose.inverse().transform(person)));
    }
    gaps_m
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(2_000))]

    #[test]
    fn fg_req_034_straight_drive_passes_people_beside(
        linear_mps in -1.0_f32..1.0,
        (gap_to_edge_m, aside_m, is_left) in (0.3_f32..1.4, 0.6_f32..1.2, any::<bool>()),
        (sigma_m, drift_mps) in (0.0_f32..0.2, -0.1_f32..0.1),
        (share, bearing) in (0.0_f32..1.0, -3.2_f32..3.2),
    ) {
        let twist = Twist2 { linear_mps, angular_radps: 0.0 };
        let x_m = if linear_mps < 0.0 { -0.45 + gap_to_edge_m } else { 0.95 - gap_to_edge_m };
        let y_m = if is_left { aside_m } else { -aside_m };
        let person = AdvisedPerson {
            position: Point2::new(x_m, y_m),
            velocity_mps: Point2::new(0.0, drift_mps),
            position_sigma_m: sigma_m,
            ..AdvisedPerson::default()
        };
        prop_assume!(BODY.recedes_from(&person, twist));
        // Wherever in the doubt the person stands outside of the body now, the motion brings no point of it there.
        let off_m = 2.0 * sigma_m * share;
        let there = Point2::new(x_m + off_m * bearing.cos(), y_m + off_m * bearing.sin());
        prop_assume!(BODY.distance_m(there) > 0.0);
        let gaps_m = gaps_m(there, twist);
        let least_m = gaps_m.iter().copied().fold(f32::INFINITY, f32::min);
        prop_assert!(least_m >= gaps_m[0] - 2.0e-3, "{} m became {least_m} m", gaps_m[0]);
    }

    #[test]
    fn fg_req_034_straight_drive_touches_no_person_beside(
        linear_mps in -1.0_f32..1.0,
        (gap_to_edge_m, aside_m, is_left) in (0.0_f32..1.4, 0.6_f32..1.2, any::<bool>()),
        sigma_m in 0.0_f32..0.2,
        (share, bearing) in (0.0_f32..1.0, -3.2_f32..3.2),
    ) {
        let twist = Twist2 { linear_mps, angular_radps: 0.0 };
        let x_m = if linear_mps < 0.0 { -0.45 + gap_to_edge_m } else { 0.95 - gap_to_edge_m };
        let y_m = if is_left { aside_m } else { -aside_m };
        let position = Point2::new(x_m, y_m);
        let person = AdvisedPerson { position, position_sigma_m: sigma_m, ..AdvisedPerson::default() };
        prop_assume!(BODY.recedes_from(&person, twist));
        // Any part of a person who stands anywhere in the doubt.
        let off_m = (0.3 + 2.0 * sigma_m) * share;
        let part = Point2::new(x_m + off_m * bearing.cos(), y_m + off_m * bearing.sin());
        let gaps_m = gaps_m(part, twist);
        prop_assume!(gaps_m[0] > 0.0);
        prop_assert!(gaps_m.iter().all(|gap_m| *gap_m > 0.0), "{part:?}");
    }

    #[test]
    fn fg_req_034_receding_robot_comes_nearer_to_no_person(
        (linear_mps, angular_radps) in (-1.0_f32..1.0, prop_oneof![Just(0.0_f32), 0.051_f32..0.4, -0.4_f32..-0.051]),
        (behind_m, y_m) in (0.0_f32..2.0, -1.0_f32..1.0),
        sigma_m in 0.0_f32..0.3,
        (share, bearing) in (0.0_f32..1.0, -3.2_f32..3.2),
    ) {
        let twist = Twist2 { linear_mps, angular_radps };
        let x_m = if linear_mps > 0.0 { -0.45 - behind_m } else { 0.95 + behind_m };
        let person = AdvisedPerson {
            position: Point2::new(x_m, y_m),
            position_sigma_m: sigma_m,
            ..AdvisedPerson::default()
        };
        prop_assume!(BODY.recedes_from(&person, twist));
        let off_m = 2.0 * sigma_m * share;
        let there = Point2::new(x_m + off_m * bearing.cos(), y_m + off_m * bearing.sin());
        let gaps_m = gaps_m(there, twist);
        let least_m = gaps_m.iter().copied().fold(f32::INFINITY, f32::min);
        prop_assert!(least_m >= gaps_m[0] - 2.0e-3, "{} m became {least_m} m", gaps_m[0]);
    }

    #[test]
    fn fg_req_034_doubt_never_makes_a_robot_recede(
        (linear_mps, angular_radps) in (-1.0_f32..1.0, -0.6_f32..0.6),
        (x_m, y_m) in (-2.0_f32..2.0, -2.0_f32..2.0),
        (sigma_m, more_m) in (0.0_f32..0.3, 0.0_f32..0.5),
    ) {
        let twist = Twist2 { linear_mps, angular_radps };
        let certain = AdvisedPerson {
            position: Point2::new(x_m, y_m),
            position_sigma_m: sigma_m,
            ..AdvisedPerson::default()
        };
        let doubtful = AdvisedPerson { position_sigma_m: sigma_m + more_m, ..certain };
        prop_assert!(BODY.recedes_from(&certain, twist) || !BODY.recedes_from(&doubtful, twist));
    }

    #[test]
    fn fg_req_033_doubt_exempts_no_person(
        (linear_mps, angular_radps) in (-1.0_f32..1.0, prop_oneof![Just(0.0_f32), -0.2_f32..0.2]),
        place in (-2.0_f32..2.5, -2.0_f32..2.0),
        velocity in (-1.5_f32..1.5, -1.5_f32..1.5),
        (more_m, more_mps) in (0.0_f32..0.5, 0.0_f32..0.5),
    ) {
        let twist = Twist2 { linear_mps, angular_radps };
        let certain = seen(place, velocity);
        let doubtful = AdvisedPerson {
            position_sigma_m: certain.position_sigma_m + more_m,
            velocity_sigma_mps: certain.velocity_sigma_mps + more_mps,
            ..certain
        };
        prop_assert!(BODY.is_exempt_from_near_limit(&certain, twist) || !BODY.is_exempt_from_near_limit(&doubtful, twist));
    }

    /// A person exempt from the limit is farther away a quarter of a second later, wherever the doubt of the velocity points.
    #[test]
    fn fg_req_031_exempt_people_are_farther_soon(
        linear_mps in 0.05_f32..1.0,
        place in (-2.0_f32..2.5, -2.0_f32..2.0),
        velocity in (-1.5_f32..1.5, -1.5_f32..1.5),
    ) {
        let seen = seen(place, velocity);
        if place.0 < -0.45 || !BODY.is_exempt_from_near_limit(&seen, Twist2 { linear_mps, angular_radps: 0.0 }) {
            return Ok(());
        }
        let after = |time_s: f32| {
            BODY.distance_m(Point2::new(place.0 + (velocity.0 - linear_mps) * time_s, place.1 + velocity.1 * time_s))
        };
        prop_assert!(after(0.25) >= after(0.0) - 1.0e-4, "{} {}", after(0.0), after(0.25));
    }
}
