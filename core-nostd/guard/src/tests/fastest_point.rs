//! The whole body keeps to the limits, and stands when it is held.

use proptest::prelude::*;

use super::fixtures::{Rig, config, forward};
use crate::*;
use floorguard_types::geometry::{Point2, Twist2};
use floorguard_types::sensing::{DriveFeedback, DriveState};

fn turning(linear_mps: f32, angular_radps: f32) -> Twist2 {
    Twist2 { linear_mps, angular_radps }
}

/// Speed of the fastest corner of the footprint, m/s, by the velocity of a point of a rigid body.
fn corner_mps(twist: Twist2) -> f64 {
    let speed = |corner: &Point2| {
        let (v, w) = (f64::from(twist.linear_mps), f64::from(twist.angular_radps));
        (v - w * f64::from(corner.y_m)).hypot(w * f64::from(corner.x_m))
    };
    config().footprint.iter().map(speed).fold(0.0, f64::max)
}

/// Somebody stands 1 m beside the robot, which drives a bend.
#[test]
fn fg_req_056_no_corner_is_faster_than_permitted_near_people() {
    for wanted in [turning(0.8, 0.7), turning(0.8, -0.7), turning(0.3, 0.7), turning(0.0, 0.7), forward(0.8)]
    {
        let mut rig = Rig::cruising();
        rig.wanted = wanted;
        let beside = AdvisedPerson { position: Point2::new(-0.2, 1.4), ..AdvisedPerson::default() };
        rig.people.push(beside);
        let mut fastest_mps = 0.0_f64;
        for _ in 0..400 {
            let decision = rig.step();
            if decision.action == Action::Limit {
                fastest_mps = fastest_mps.max(corner_mps(decision.permitted));
            }
        }
        // As fast as permitted, and no faster.
        assert!((0.29..=0.3 + 1.0e-4).contains(&fastest_mps), "{wanted:?}: {fastest_mps} m/s");
    }
}

proptest! {
    #[test]
    fn fg_req_056_fastest_point_is_a_corner(v in -1.5_f32..1.5, w in -2.0_f32..2.0) {
        let found = f64::from(fastest_mps(&config().footprint, turning(v, w)));
        prop_assert!((found - corner_mps(turning(v, w))).abs() < 1.0e-5);
    }
}

#[test]
fn fg_req_050_spinning_instead_of_standing_is_latched() {
    // By the encoders, or by the drive with its wheel across.
    for (wheels, drive_mps) in [(turning(0.0, 0.9), 0.0), (Twist2::ZERO, 0.72)] {
        let mut rig = Rig::cruising();
        (rig.wanted, rig.measured) = (Twist2::ZERO, Twist2::ZERO);
        rig.run_ms(3_000);
        rig.silent = std::vec![Source::Wheels, Source::Drive];
        for _ in 0..15 {
            rig.guard.on_wheels(wheels, rig.now, rig.now);
            let feedback = DriveFeedback {
                stamp: rig.now,
                state: DriveState::Enabled,
                wheel_speed_mps: drive_mps,
                steering_rad: core::f32::consts::FRAC_PI_2,
            };
            rig.guard.on_drive(&feedback, rig.now);
            rig.step();
        }
        let causes: std::vec::Vec<Cause> = rig.guard.causes().map(|record| record.cause).collect();
        assert!(causes.contains(&Cause::Overspeed), "{wheels:?} {drive_mps}: {causes:?}");
    }
}

/// A robot that an obstacle holds, and its encoders or its drive tell that it moves: how far a corner went until the
/// torque was off, metres; `None`: it never was.
fn crept(creep: Twist2, source: Source) -> Option<f64> {
    let mut rig = Rig::cruising();
    rig.obstacles.push(Point2::new(1.1, 0.0));
    rig.run_ms(3_000);
    rig.silent = std::vec![source];
    for step in 0..3_000_u32 {
        if source == Source::Wheels {
            rig.guard.on_wheels(creep, rig.now, rig.now);
        } else {
            let state = DriveState::Enabled;
            let wheel_speed_mps = creep.linear_mps;
            let feedback = DriveFeedback { stamp: rig.now, state, wheel_speed_mps, steering_rad: 0.0 };
            rig.guard.on_drive(&feedback, rig.now);
        }
        let decision = rig.step();
        if decision.torque_off {
            assert_eq!((decision.action, decision.state), (Action::Category0, GuardState::Latched));
            return Some(corner_mps(creep) * f64::from(step) * 0.01);
        }
    }
    None
}

#[test]
fn fg_req_057_a_held_robot_creeps_no_farther_than_stated() {
    let creeps = [forward(0.002), forward(-0.01), forward(0.04), turning(0.0, 0.002), turning(0.01, -0.03)];
    for creep in creeps {
        let moved_m = crept(creep, Source::Wheels);
        assert!(moved_m.is_some_and(|moved_m| moved_m < 0.0206), "{creep:?}: {moved_m:?} m");
    }
    let moved_m = crept(forward(-0.03), Source::Drive);
    assert!(moved_m.is_some_and(|moved_m| moved_m < 0.0206), "by the drive: {moved_m:?} m");
    assert_eq!((crept(Twist2::ZERO, Source::Wheels), crept(Twist2::ZERO, Source::Drive)), (None, None));
}

#[test]
fn fg_req_057_noise_around_zero_is_no_creeping() {
    let mut rig = Rig::cruising();
    rig.obstacles.push(Point2::new(1.1, 0.0));
    rig.run_ms(3_000);
    rig.silent = std::vec![Source::Wheels];
    for step in 0..2_000 {
        let sign = if step % 2 == 0 { 1.0 } else { -1.0 };
        rig.guard.on_wheels(turning(sign * 0.02, sign * 0.02), rig.now, rig.now);
        assert_eq!(rig.step().action, Action::Category2);
    }
}

#[test]
fn fg_req_057_a_robot_that_leaves_is_not_held() {
    let mut rig = Rig::cruising();
    rig.obstacles.push(Point2::new(1.1, 0.0));
    rig.run_ms(3_000);
    rig.wanted = forward(-0.2);
    let decision = rig.run_ms(1_500);
    assert!(decision.permitted.linear_mps < -0.05, "{decision:?}");
    assert_eq!(rig.guard.latches(), 0);
}
