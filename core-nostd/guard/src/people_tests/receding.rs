//! FG-REQ-034 against the whole guard: people behind a robot that drives away, and beside one that drives straight.

use crate::tests::fixtures::{Rig, config};
use crate::*;
use floorguard_types::geometry::{Point2, Twist2};

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
