//! Where no sensor looks, the body goes no faster than is accepted there.

use super::fixtures::{Rig, config, forward};
use crate::*;
use floorguard_types::geometry::{Point2, Twist2};

fn spin(radps: f32) -> Twist2 {
    Twist2 { linear_mps: 0.0, angular_radps: radps }
}

#[test]
fn fg_req_029_the_body_goes_into_each_region_as_fast_as_is_accepted_there() {
    let box_m = [[-0.45, 0.95], [-0.4, 0.4]];
    let into = |region: Region, twist| region.speed_into_mps(twist, box_m);
    assert_eq!((into(Region::Ahead, forward(0.5)), into(Region::Rear, forward(-0.2))), (0.5, 0.2));
    assert!(into(Region::Ahead, forward(-0.2)) <= 0.0 && into(Region::Rear, forward(0.5)) <= 0.0);
    // Turning left swings the front to the left and the tail to the right.
    assert!((into(Region::AheadLeft, spin(0.8)) - 0.76).abs() < 1.0e-6);
    assert!((into(Region::RearRight, spin(0.8)) - 0.36).abs() < 1.0e-6);
    assert!(into(Region::RearLeft, spin(0.8)) < 0.0 && into(Region::AheadRight, spin(0.8)) < 0.0);
    let mut config = config();
    config.unseen.toward_mps[1] = 0.1;
    let mut rig = Rig::with(config);
    rig.wanted = forward(-0.25);
    let decision = rig.run_ms(3_000);
    assert!((decision.permitted.linear_mps + 0.1).abs() < 1.0e-3, "{decision:?}");
    assert_eq!(decision.primary_cause.unwrap().cause, Cause::WayUnseen);
}

#[test]
fn fg_req_029_beside_the_tail_nobody_has_looked_before_the_robot_came_forward() {
    let mut rig = Rig::new();
    rig.wanted = spin(0.6);
    let first = rig.run_ms(3_000).permitted.angular_radps;
    assert!((first * 0.45 - 0.1).abs() < 1.0e-3, "the tail goes at the speed of a contact: {first}");
    rig.wanted = forward(0.8);
    rig.run_ms(5_000);
    rig.wanted = spin(0.6);
    let later = rig.run_ms(4_000).permitted.angular_radps;
    assert!(later > 1.5 * first, "{later}");
}

#[test]
fn fg_req_027_a_turn_stops_before_what_was_seen_beside_the_tail() {
    // A box stands beside the tail, where no beam of the scanner reaches it: only the memory knows.
    let mut rig = Rig::cruising();
    rig.wanted = Twist2::ZERO;
    rig.run_ms(3_000);
    let pose = rig.guard.memory.pose_at(rig.now);
    for along in 0..6_u8 {
        let place = pose.transform(Point2::new(-0.44 + f32::from(along) * 0.05, -0.5));
        rig.guard.memory.set_scanned(Cell::of(place), true);
    }
    rig.wanted = spin(0.5);
    let mut turned_rad = 0.0_f32;
    for _ in 0..400 {
        turned_rad += rig.step().permitted.angular_radps * 0.01;
    }
    // The right rear corner lies 0.602 m from the axle; from -0.40 m it would reach -0.50 m after 0.2 rad or so.
    let reach_m = 0.45 * turned_rad.sin() + 0.4 * turned_rad.cos();
    assert!(reach_m < 0.5 && turned_rad < 0.3, "turned by {turned_rad} rad, the tail is at {reach_m} m");
    assert!(rig.guard.causes().any(|record| matches!(record.cause, Cause::WayClosed | Cause::WayNarrow)));
    rig.wanted = spin(-0.5);
    rig.run_ms(1_500);
    let away = rig.step().permitted.angular_radps;
    assert!(away < 0.0, "the other way is free: {away}");
}
