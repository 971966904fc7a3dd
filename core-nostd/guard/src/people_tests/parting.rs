//! A stop for a person ends when that person is seen to part, and a limit holds for nobody whom the robot leaves.

use crate::tests::fixtures::{Rig, forward};
use crate::*;
use floorguard_types::geometry::{Point2, Twist2};
use floorguard_types::time::Stamp;

fn person(id: u32, place: (f32, f32), velocity: (f32, f32)) -> AdvisedPerson {
    AdvisedPerson {
        id,
        position: Point2::new(place.0, place.1),
        velocity_mps: Point2::new(velocity.0, velocity.1),
        position_sigma_m: 0.05,
        velocity_sigma_mps: 0.1,
    }
}

/// A robot that is held by person 7, who comes towards its nose.
fn held() -> Rig {
    let mut rig = Rig::cruising();
    rig.people.push(person(7, (1.9, 0.0), (-1.0, 0.0)));
    rig.run_ms(100);
    assert!(rig.guard.causes().any(|record| record.cause == Cause::CollisionStop));
    rig
}

/// Milliseconds until the stop for a person ends, when the lists say this from now on.
fn held_for_ms(mut rig: Rig, people: &[AdvisedPerson]) -> u32 {
    rig.people = people.to_vec();
    let mut lasted_ms = 0;
    while rig.guard.causes().any(|record| record.cause == Cause::CollisionStop) && lasted_ms < 5_000 {
        rig.run_ms(10);
        lasted_ms += 10;
    }
    lasted_ms
}

#[test]
fn fg_req_086_seen_parting_ends_the_stop() {
    let parts = person(7, (1.4, 1.2), (0.1, 1.0));
    let parted_ms = held_for_ms(held(), &[parts]);
    assert!((100..=350).contains(&parted_ms), "two lists, {parted_ms} ms");
    assert!(held_for_ms(held(), &[]) >= 900, "who is seen no more may stand behind a shelf");
    let other = AdvisedPerson { id: 8, ..parts };
    assert!(held_for_ms(held(), &[other]) >= 900, "somebody else parts");
    let doubtful = AdvisedPerson { velocity_sigma_mps: 2.0, ..parts };
    assert!(held_for_ms(held(), &[doubtful]) >= 900, "they may come back by their doubt");
    let comes = person(9, (1.9, 0.2), (-1.0, 0.0));
    assert_eq!(held_for_ms(held(), &[parts, comes]), 5_000, "another one comes");
}

/// A list that perception repeats, and one that is not from the past, show nothing new.
#[test]
fn fg_req_086_repeated_lists_end_no_stop() {
    let (now, old) = (Stamp::from_micros(5_000_000), Stamp::from_micros(4_900_000));
    let held = || {
        let mut stopper = Stopper::NONE;
        assert!(!stopper.follow((Some(7), false), Stamp::from_micros(4_000_000), now));
        assert_eq!(stopper.id(), Some(7));
        stopper
    };
    let mut repeated = held();
    assert!((0..50).all(|_| !repeated.follow((None, true), old, now)));
    let mut future = held();
    assert!((1..50).all(|step| !future.follow((None, true), Stamp::from_micros(5_000_000 + step), now)));
    let mut fresh = held();
    assert!(!fresh.follow((None, true), old, now));
    assert!(fresh.follow((None, true), Stamp::from_micros(4_950_000), now));
    assert_eq!(fresh.id(), None, "the stop has ended");
    let mut broken = held();
    for (step, parts) in [true, false, true].into_iter().enumerate() {
        assert!(!broken.follow((None, parts), Stamp::from_micros(4_900_000 + step as u64), now), "in a row");
    }
}

#[test]
fn fg_req_086_flipped_bit_ends_no_stop() {
    let now = Stamp::from_micros(5_000_000);
    let begun = || {
        let mut stopper = Stopper::NONE;
        stopper.follow((Some(7), false), Stamp::from_micros(4_000_000), now);
        assert!(!stopper.follow((None, true), Stamp::from_micros(4_100_000), now));
        stopper
    };
    for bit in 0..32 {
        let mut stopper = begun();
        stopper.id ^= 1 << bit;
        assert_eq!(stopper.id(), None);
        assert!(!stopper.follow((None, true), Stamp::from_micros(4_200_000), now));
    }
    let mut lists = begun();
    lists.parting_lists = 2;
    assert!(!lists.follow((None, true), Stamp::from_micros(4_200_000), now));
    assert!(begun().follow((None, true), Stamp::from_micros(4_200_000), now), "whole, it ends it");
}

/// What limits a robot that drives straight on with 0.8 m/s, m/s.
fn limit_mps(person: AdvisedPerson) -> f32 {
    let mut rig = Rig::cruising();
    rig.people.push(person);
    rig.run_ms(300).speed_limit_mps
}

#[test]
fn fg_req_031_people_left_behind_limit_no_speed() {
    assert!(limit_mps(person(1, (-1.1, 0.0), (0.0, 0.0))) > 0.5, "behind");
    assert!(limit_mps(person(1, (0.2, 1.2), (0.0, 0.6))) > 0.5, "walks off to the side");
    assert!(limit_mps(person(1, (-0.8, 0.0), (0.8, 0.0))) <= 0.3, "close behind, and as fast");
    assert!(limit_mps(person(1, (0.2, 1.2), (0.0, 0.0))) <= 0.3, "stands beside it");
    assert!(limit_mps(person(1, (0.2, 1.2), (0.0, 0.05))) <= 0.3, "its velocity is not sure enough");
}

#[test]
fn fg_req_032_standing_robot_is_not_stopped_again() {
    let comes = person(3, (1.9, 0.0), (-1.6, 0.0));
    let stops = |wanted: Twist2| {
        let mut rig = Rig::cruising();
        (rig.measured, rig.wanted) = (Twist2::ZERO, wanted);
        rig.run_ms(200);
        rig.measured = Twist2::ZERO;
        let people = [comes].into_iter().collect();
        rig.guard.on_wheels(Twist2::ZERO, rig.now, rig.now);
        rig.guard.on_command(wanted, rig.now, rig.now);
        rig.guard.on_advice(&Advice { stamp: rig.now, people, ..Advice::default() }, rig.now);
        rig.guard.causes().any(|record| record.cause == Cause::CollisionStop)
    };
    assert!(!stops(Twist2::ZERO), "it reaches nobody");
    assert!(stops(forward(0.3)), "it may not set off");
}
