//! The whole body keeps to the limits, and stands when it is held.

use proptest::prelude::*;

use super::fixtures::{Rig, config, forward};
use crate::*;
use floorguard_types::geometry::{Point2, Twist2};

fn turning(linear_mps: f32, angular_radps: f32) -> Twist2 {
    Twist2 { linear_mps, angular_radps }
}

/// Speed of the fastest corner of the footprint, m/s.
fn fastest_mps(twist: Twist2) -> f64 {
    let speed = |corner: &Point2| {
        let (v, w) = (f64::from(twist.linear_mps), f64::from(twist.angular_radps));
        (v - w * f64::from(corner.y_m)).hypot(w * f64::from(corner.x_m))
    };
    config().footprint.iter().map(speed).fold(0.0, f64::max)
}

fn causes(rig: &Rig) -> std::vec::Vec<Cause> {
    rig.guard.causes().map(|record| record.cause).collect()
}

/// Somebody stands 1 m beside the robot, which drives a bend.
#[test]
fn fg_req_056_near_people_no_corner_of_the_body_is_faster_than_permitted() {
    for wanted in [turning(0.8, 0.7), turning(0.8, -0.7), turning(0.3, 0.7), turning(0.0, 0.7), forward(0.8)] {
        let mut rig = Rig::cruising();
        rig.wanted = wanted;
        let beside = AdvisedPerson { position: Point2::new(-0.2, 1.4), ..AdvisedPerson::default() };
        rig.people.push(beside);
        let mut moved = false;
        for _ in 0..400 {
            let decision = rig.step();
            moved |= decision.permitted != Twist2::ZERO;
            let limited = decision.action == Action::Limit;
            let fastest_mps = fastest_mps(decision.permitted);
            assert!(!limited || fastest_mps <= 0.3 + 1.0e-4, "{wanted:?}: {fastest_mps} m/s: {decision:?}");
        }
        assert!(moved, "{wanted:?}");
    }
}

proptest! {
    #[test]
    fn fg_req_056_the_fastest_point_is_that_of_the_corners(v in -1.5_f32..1.5, w in -2.0_f32..2.0) {
        let body = Body::around(&config().footprint);
        let found = f64::from(body.fastest_mps(turning(v, w)));
        prop_assert!((found - fastest_mps(turning(v, w))).abs() < 1.0e-5);
    }
}

#[test]
fn fg_req_050_a_robot_that_spins_although_it_is_to_stand_is_latched() {
    // By the encoders, or by the drive with its wheel across.
    for (wheels, drive_mps) in [(turning(0.0, 0.9), 0.0), (Twist2::ZERO, 0.72)] {
        let mut rig = Rig::cruising();
        (rig.wanted, rig.measured) = (Twist2::ZERO, Twist2::ZERO);
        rig.run_ms(3_000);
        rig.silent = std::vec![Source::Wheels, Source::Drive];
        for _ in 0..15 {
            rig.guard.on_wheels(wheels, rig.now, rig.now);
            let steering_rad = core::f32::consts::FRAC_PI_2;
            let state = floorguard_types::sensing::DriveState::Enabled;
            let wheel_speed_mps = drive_mps;
            let feedback = floorguard_types::sensing::DriveFeedback {
                stamp: rig.now,
                state,
                wheel_speed_mps,
                steering_rad,
            };
            rig.guard.on_drive(&feedback, rig.now);
            rig.step();
        }
        assert!(causes(&rig).contains(&Cause::Overspeed), "{wheels:?} {drive_mps}: {:?}", causes(&rig));
    }
}

/// Held by an obstacle, and creeping: metres and degrees until the robot is latched, and the cause.
fn crept(creep: Twist2) -> (f32, f32, bool) {
    let mut rig = Rig::cruising();
    rig.obstacles.push(Point2::new(1.1, 0.0));
    rig.run_ms(3_000);
    rig.silent = std::vec![Source::Wheels];
    let (mut moved_m, mut turned_rad) = (0.0_f32, 0.0_f32);
    for _ in 0..3_000 {
        rig.now = rig.now.plus_micros(0);
        rig.guard.on_wheels(creep, rig.now, rig.now);
        if causes(&rig).contains(&Cause::StandstillLost) {
            return (moved_m, turned_rad.to_degrees(), true);
        }
        rig.step();
        moved_m += creep.linear_mps * 0.01;
        turned_rad += creep.angular_radps * 0.01;
    }
    (moved_m, turned_rad.to_degrees(), false)
}

#[test]
fn fg_req_057_a_held_robot_that_creeps_is_latched_within_two_centimetres_or_half_a_degree() {
    for creep in [forward(0.002), forward(-0.01), forward(0.04), turning(0.0, 0.002), turning(0.0, -0.03)] {
        let (moved_m, turned_deg, noticed) = crept(creep);
        assert!(noticed, "{creep:?} went on for {moved_m} m and {turned_deg} degrees");
        assert!(moved_m.abs() < 0.0206 && turned_deg.abs() < 0.53, "{creep:?}: {moved_m} m, {turned_deg} degrees");
    }
    assert!(!crept(Twist2::ZERO).2, "a robot that stands is none that creeps");
}

#[test]
fn fg_req_057_noise_around_zero_and_the_way_to_standstill_are_no_creeping() {
    let mut rig = Rig::cruising();
    rig.obstacles.push(Point2::new(1.1, 0.0));
    rig.run_ms(3_000);
    rig.silent = std::vec![Source::Wheels];
    for step in 0..2_000 {
        let sign = if step % 2 == 0 { 1.0 } else { -1.0 };
        rig.guard.on_wheels(turning(sign * 0.02, sign * 0.02), rig.now, rig.now);
        rig.step();
    }
    assert!(!causes(&rig).contains(&Cause::StandstillLost), "{:?}", causes(&rig));
    assert_eq!(Cause::StandstillLost.action(), Action::Category1);
    assert_eq!(Cause::StandstillLost.clear(), Clear::Reset);
}
