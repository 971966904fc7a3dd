//! When a stop for people ends, and which people near the robot do not limit its speed.

use crate::people::StopTriggers;
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
fn fg_req_086_seen_diverging_ends_the_stop() {
    let diverges = person(7, (1.4, 1.2), (0.1, 1.0));
    let lasted_ms = held_for_ms(held(), &[diverges]);
    assert!((100..=350).contains(&lasted_ms), "two lists, {lasted_ms} ms");
    assert!(held_for_ms(held(), &[]) >= 900, "who is seen no more may stand behind a shelf");
    let other = AdvisedPerson { id: 8, ..diverges };
    assert!(held_for_ms(held(), &[other]) >= 900, "another person diverges");
    let doubtful = AdvisedPerson { velocity_sigma_mps: 2.0, ..diverges };
    assert!(held_for_ms(held(), &[doubtful]) >= 900, "within the doubt the person may come back");
    let comes = person(9, (1.9, 0.2), (-1.0, 0.0));
    assert_eq!(held_for_ms(held(), &[diverges, comes]), 5_000, "another one comes");
}

/// Two people come, and both must be seen to diverge: one of them may be hidden by then.
#[test]
fn fg_req_086_each_person_must_be_seen_diverging() {
    let diverges = |id| person(id, (1.4, 1.2), (0.1, 1.0));
    let held_by = |count: u32| {
        let mut rig = held();
        rig.people =
            (7..7 + count).map(|id| person(id, (1.9, 0.02 * id as f32 - 0.14), (-1.0, 0.0))).collect();
        rig.run_ms(100);
        rig
    };
    assert!(held_for_ms(held_by(2), &[diverges(7)]) >= 900, "8 is silence");
    assert!(held_for_ms(held_by(2), &[diverges(8)]) >= 900, "7 is silence");
    assert!(held_for_ms(held_by(2), &[diverges(7), diverges(7)]) >= 900, "once is not twice");
    assert!(held_for_ms(held_by(2), &[diverges(7), diverges(8)]) <= 350);
    let all = |count: u32| (7..7 + count).map(diverges).collect::<std::vec::Vec<_>>();
    assert!(held_for_ms(held_by(4), &all(4)) <= 350);
    assert!(held_for_ms(held_by(5), &all(5)) >= 900, "more people than are kept");
}

/// Held by person 7 since 4 s.
fn triggered() -> StopTriggers {
    let mut triggers = StopTriggers::NONE;
    triggers.add(7);
    assert!(!triggers.follow((true, 0), Stamp::from_micros(4_000_000), NOW));
    assert_eq!((triggers.bit(7), triggers.bit(8)), (1, 0));
    triggers
}

const NOW: Stamp = Stamp::from_micros(5_000_000);

/// A list that perception repeats, and one that is not from the past, show nothing new.
#[test]
fn fg_req_086_repeated_lists_end_no_stop() {
    let old = Stamp::from_micros(4_900_000);
    let diverges = (false, 1);
    let mut repeated = triggered();
    assert!((0..50).all(|_| !repeated.follow(diverges, old, NOW)));
    let mut future = triggered();
    assert!((1..50).all(|step| !future.follow(diverges, Stamp::from_micros(5_000_000 + step), NOW)));
    let mut fresh = triggered();
    assert!(!fresh.follow(diverges, old, NOW));
    assert!(fresh.follow(diverges, Stamp::from_micros(4_950_000), NOW));
    fresh.forget();
    assert_eq!(fresh.bit(7), 0, "the stop has ended");
    let mut broken = triggered();
    for (step, bits) in [1, 0, 1].into_iter().enumerate() {
        assert!(
            !broken.follow((false, bits), Stamp::from_micros(4_900_000 + step as u64), NOW),
            "consecutive"
        );
    }
}

#[test]
fn fg_req_086_flipped_bit_ends_no_stop() {
    let begun = || {
        let mut triggers = triggered();
        assert!(!triggers.follow((false, 1), Stamp::from_micros(4_100_000), NOW));
        triggers
    };
    let ends = |mut triggers: StopTriggers| triggers.follow((false, 1), Stamp::from_micros(4_200_000), NOW);
    assert!(ends(begun()), "whole, it ends it");
    for (place, bit) in (0..4).flat_map(|place| (0..32).map(move |bit| (place, bit))) {
        let mut flipped = begun();
        flipped.ids[place] ^= 1 << bit;
        assert_eq!(flipped.bit(7), 0);
        assert!(!ends(flipped));
        flipped.add(8);
        assert!(!ends(flipped), "nor does it after the next person");
        flipped.forget();
        assert_eq!(
            flipped,
            {
                let mut fresh = StopTriggers::NONE;
                fresh.forget();
                fresh
            },
            "the next stop begins anew"
        );
    }
    for bit in 0..8 {
        let mut lists = begun();
        lists.diverging_lists ^= 1 << bit;
        assert!(!ends(lists));
    }
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
