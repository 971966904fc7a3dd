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

/// Whether a person who comes with a velocity along x stops a robot that drives with a speed along x.
fn stops(x_m: f32, velocity_mps: f32, speed_mps: f32) -> bool {
    let mut rig = Rig::with(config());
    rig.run_ms(1_500);
    let twist = Twist2 { linear_mps: speed_mps, angular_radps: 0.0 };
    rig.guard.on_wheels(twist, rig.now, rig.now);
    rig.guard.on_command(twist, rig.now, rig.now);
    let person = AdvisedPerson {
        position: Point2::new(x_m, 0.0),
        velocity_mps: Point2::new(velocity_mps, 0.0),
        ..AdvisedPerson::default()
    };
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
