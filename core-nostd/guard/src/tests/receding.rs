//! Nobody is left out who could be reached: receding robots against people who may stand anywhere within the doubt.

use proptest::prelude::*;

use super::fixtures::{Rig, config};
use crate::*;
use floorguard_types::geometry::{Point2, Pose2, Twist2};

/// Gaps of a turning robot to a person who stands, every 0.05 s for 1.5 s: longer than it needs to stop.
fn gaps_m(body: &Body, person: Point2, twist: Twist2) -> std::vec::Vec<f32> {
    let (mut pose, mut gaps_m) = (Pose2::default(), std::vec![body.distance_m(person)]);
    for _ in 0..30 {
        pose = pose.compose(Pose2::new(twist.linear_mps * 0.05, 0.0, twist.angular_radps * 0.05));
        gaps_m.push(body.distance_m(pose.inverse().transform(person)));
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
        let body = Body::around(&config().footprint);
        let twist = Twist2 { linear_mps, angular_radps: 0.0 };
        let x_m = if linear_mps < 0.0 { -0.45 + gap_to_edge_m } else { 0.95 - gap_to_edge_m };
        let y_m = if is_left { aside_m } else { -aside_m };
        let person = AdvisedPerson {
            position: Point2::new(x_m, y_m),
            velocity_mps: Point2::new(0.0, drift_mps),
            position_sigma_m: sigma_m,
            ..AdvisedPerson::default()
        };
        prop_assume!(body.recedes_from(&person, twist));
        // Wherever in the doubt the person stands outside of the body now, the motion brings no point of it there.
        let off_m = 2.0 * sigma_m * share;
        let there = Point2::new(x_m + off_m * bearing.cos(), y_m + off_m * bearing.sin());
        prop_assume!(body.distance_m(there) > 0.0);
        let gaps_m = gaps_m(&body, there, twist);
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
        let body = Body::around(&config().footprint);
        let twist = Twist2 { linear_mps, angular_radps: 0.0 };
        let x_m = if linear_mps < 0.0 { -0.45 + gap_to_edge_m } else { 0.95 - gap_to_edge_m };
        let y_m = if is_left { aside_m } else { -aside_m };
        let position = Point2::new(x_m, y_m);
        let person = AdvisedPerson { position, position_sigma_m: sigma_m, ..AdvisedPerson::default() };
        prop_assume!(body.recedes_from(&person, twist));
        // Any part of a person who stands anywhere in the doubt.
        let off_m = (0.3 + 2.0 * sigma_m) * share;
        let part = Point2::new(x_m + off_m * bearing.cos(), y_m + off_m * bearing.sin());
        let gaps_m = gaps_m(&body, part, twist);
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
        let body = Body::around(&config().footprint);
        let twist = Twist2 { linear_mps, angular_radps };
        let x_m = if linear_mps > 0.0 { -0.45 - behind_m } else { 0.95 + behind_m };
        let person = AdvisedPerson {
            position: Point2::new(x_m, y_m),
            position_sigma_m: sigma_m,
            ..AdvisedPerson::default()
        };
        prop_assume!(body.recedes_from(&person, twist));
        let off_m = 2.0 * sigma_m * share;
        let there = Point2::new(x_m + off_m * bearing.cos(), y_m + off_m * bearing.sin());
        let gaps_m = gaps_m(&body, there, twist);
        let least_m = gaps_m.iter().copied().fold(f32::INFINITY, f32::min);
        prop_assert!(least_m >= gaps_m[0] - 2.0e-3, "{} m became {least_m} m", gaps_m[0]);
    }

    #[test]
    fn fg_req_034_doubt_never_makes_a_robot_recede(
        (linear_mps, angular_radps) in (-1.0_f32..1.0, -0.6_f32..0.6),
        (x_m, y_m) in (-2.0_f32..2.0, -2.0_f32..2.0),
        (sigma_m, more_m) in (0.0_f32..0.3, 0.0_f32..0.5),
    ) {
        let body = Body::around(&config().footprint);
        let twist = Twist2 { linear_mps, angular_radps };
        let certain = AdvisedPerson {
            position: Point2::new(x_m, y_m),
            position_sigma_m: sigma_m,
            ..AdvisedPerson::default()
        };
        let doubtful = AdvisedPerson { position_sigma_m: sigma_m + more_m, ..certain };
        prop_assert!(body.recedes_from(&certain, twist) || !body.recedes_from(&doubtful, twist));
    }
}

/// Whether a person stops a robot that drives with 0.2 m/s along x.
fn stops_beside(place: (f32, f32), velocity: (f32, f32), angular_radps: f32) -> bool {
    let person = AdvisedPerson {
        position: Point2::new(place.0, place.1),
        velocity_mps: Point2::new(velocity.0, velocity.1),
        position_sigma_m: 0.07,
        ..AdvisedPerson::default()
    };
    is_stopped_by(person, Twist2 { linear_mps: 0.2, angular_radps })
}

#[test]
fn fg_req_034_person_beside_stops_no_straight_drive() {
    // The flank is 0.40 m from the middle, the nose 0.95 m ahead of the axle.
    assert!(!stops_beside((-0.43, 0.67), (0.0, -0.01), 0.0), "stands beside the rear corner");
    assert!(!stops_beside((0.3, -0.62), (0.0, 0.05), 0.0), "stands close beside the other flank");
    assert!(stops_beside((0.3, -0.55), (0.0, 0.0), 0.0), "in contact with the flank");
    assert!(stops_beside((-0.43, 0.67), (0.0, -0.01), -0.2), "the tail would swing towards them");
    assert!(stops_beside((0.3, -0.62), (0.0, 0.15), 0.0), "comes towards the flank");
    assert!(stops_beside((0.6, 0.6), (0.0, 0.0), 0.0), "a part of them may lie ahead of the nose");
    assert!(
        !stops_beside((0.72, 0.84), (0.0, -0.01), 0.0),
        "stands beside the nose, no part of them in the way"
    );
    assert!(stops_beside((0.72, 0.75), (0.0, -0.01), 0.0), "the same, and a part of them may lie in the way");
    assert!(stops_beside((0.85, 0.84), (0.0, -0.01), 0.0), "their middle may be ahead of the nose");
    assert!(stops_beside((0.3, 0.2), (0.0, 0.0), 0.0), "in contact already");
}

/// Whether a person who comes with a velocity along x stops a robot that drives with a speed along x.
fn stops(x_m: f32, velocity_mps: f32, speed_mps: f32) -> bool {
    let person = AdvisedPerson {
        position: Point2::new(x_m, 0.0),
        velocity_mps: Point2::new(velocity_mps, 0.0),
        ..AdvisedPerson::default()
    };
    is_stopped_by(person, Twist2 { linear_mps: speed_mps, angular_radps: 0.0 })
}

fn is_stopped_by(person: AdvisedPerson, twist: Twist2) -> bool {
    let mut rig = Rig::with(config());
    rig.run_ms(1_500);
    rig.guard.on_wheels(twist, rig.now, rig.now);
    rig.guard.on_command(twist, rig.now, rig.now);
    rig.guard.on_advice(
        &Advice { stamp: rig.now, people: [person].into_iter().collect(), ..Advice::default() },
        rig.now,
    );
    rig.guard.causes().any(|record| record.cause == Cause::CollisionStop)
}

#[test]
fn fg_req_034_person_left_behind_stops_no_robot() {
    assert!(!stops(-0.45 - 0.2, 0.0, 0.3), "touched from behind, leaving");
    assert!(!stops(-0.45 - 0.2, 0.25, 0.3), "followed more slowly than it leaves");
    assert!(stops(-0.45 - 0.2, 0.35, 0.3), "followed faster than it leaves");
    assert!(stops(-0.45 - 0.8, 1.4, 0.5), "met from behind");
    assert!(stops(-0.45 - 0.8, 1.4, -0.3), "backing towards the follower");
    assert!(stops(0.95 + 0.2, 0.0, 0.3), "ahead");
    assert!(stops(0.95 + 0.8, -1.4, 0.5), "coming towards the front");
    assert!(!stops(0.95 + 0.2, -0.2, -0.3), "followed at the front, leaving backward");
}
