//! Where a stop helps nobody, and where creeping is enough.

use proptest::prelude::*;

use super::fixtures::{Rig, config};
use crate::rules::PERSON_QUIET_US;
use crate::*;
use floorguard_types::geometry::{Point2, Twist2};

fn person((x_m, y_m): (f32, f32), (x_mps, y_mps): (f32, f32)) -> AdvisedPerson {
    AdvisedPerson {
        position: Point2::new(x_m, y_m),
        velocity_mps: Point2::new(x_mps, y_mps),
        position_sigma_m: 0.07,
        velocity_sigma_mps: 0.05,
        ..AdvisedPerson::default()
    }
}

fn driving(linear_mps: f32, angular_radps: f32) -> Twist2 {
    Twist2 { linear_mps, angular_radps }
}

/// A robot that drives like this and has just seen a person.
fn met(person: AdvisedPerson, twist: Twist2) -> Rig {
    let mut rig = Rig::with(config());
    rig.run_ms(1_500);
    rig.guard.on_wheels(twist, rig.now, rig.now);
    rig.guard.on_command(twist, rig.now, rig.now);
    let people = [person].into_iter().collect();
    rig.guard.on_advice(&Advice { stamp: rig.now, people, ..Advice::default() }, rig.now);
    rig
}

fn record(rig: &Rig, cause: Cause) -> Option<CauseRecord> {
    rig.guard.causes().find(|record| record.cause == cause).copied()
}

fn stops(person: AdvisedPerson, twist: Twist2) -> bool {
    record(&met(person, twist), Cause::CollisionStop).is_some()
}

#[test]
fn fg_req_038_walker_from_behind_stops_no_robot() {
    let walker = person((-1.25, 0.1), (1.4, 0.0));
    assert!(!stops(walker, driving(0.3, 0.0)), "would walk into the standing robot all the same");
    assert!(!stops(walker, driving(0.5, 0.0)));
    assert!(stops(walker, driving(-0.2, 0.0)), "backing towards them");
    assert!(stops(walker, driving(0.1, 0.3)), "the tail swings");
    assert!(stops(person((1.75, 0.1), (-1.4, 0.0)), driving(0.3, 0.0)), "from ahead");
    // Overtakes and cuts in: a robot that stands would not be met.
    let cuts_in = person((-0.6, 1.0), (2.0, -0.4));
    assert!(!Body::around(&config().footprint).is_met_from_behind(&cuts_in, driving(0.5, 0.0)));
}

#[test]
fn fg_req_032_walker_into_the_flank_meets_a_stand() {
    // 1.6 m/s, a robot at 0.3 m/s: the stop comes while there is still time for it.
    let body = Body::around(&config().footprint);
    let twist = driving(0.3, 0.0);
    let needed_s = config().drive.clear_of_people_s(0.3);
    for step in 0..60 {
        let y_m = 0.75 + 0.05 * step as f32;
        let walker = person((0.0, y_m), (0.0, -1.6));
        let [soonest_s, _] = body.times_to_person_s(&walker, twist);
        if soonest_s < needed_s - LATER_AT_FLANK_S {
            assert!(stops(walker, twist), "{y_m} m, in {soonest_s} s");
        }
    }
    let standstill_s = config().drive.response_s + 0.3 / config().drive.braking_mps2;
    assert!(needed_s - LATER_AT_FLANK_S >= standstill_s + 0.1, "a sweep more than it takes to stand");
}

#[test]
fn fg_req_039_creeps_where_that_is_enough() {
    // Somebody walks towards the front: too soon for half a metre a second, not for a creep.
    let creeps = met(person((2.6, 0.0), (-0.6, 0.0)), driving(0.5, 0.0));
    assert!(record(&creeps, Cause::CollisionStop).is_none());
    let limit_mps = record(&creeps, Cause::CollisionSlow).expect("slows").speed_limit_mps;
    assert!((0.09..0.31).contains(&limit_mps), "{limit_mps}");
    assert!(stops(person((1.7, 0.0), (-0.6, 0.0)), driving(0.5, 0.0)), "nearer even a creep is too fast");
}

#[test]
fn fg_req_031_limit_near_people_goes_by_direction() {
    let limit_mps = |person: AdvisedPerson, twist: Twist2| {
        let rig = met(person, twist);
        let held = rig.guard.state.machine.held.iter().find(|held| held.first.cause == Cause::PersonNear);
        held.map(|held| held.limit_mps)
    };
    let twist = driving(0.4, 0.0);
    assert_eq!(limit_mps(person((2.0, 0.6), (0.0, 0.0)), twist), Some(0.3), "ahead");
    assert_eq!(limit_mps(person((0.0, 1.3), (0.0, -0.5)), twist), Some(0.3), "comes towards the flank");
    assert_eq!(limit_mps(person((0.0, 1.2), (0.0, 0.0)), twist), Some(0.5), "stands beside");
    assert_eq!(limit_mps(person((1.9, 0.0), (1.2, 0.0)), twist), Some(0.5), "walks away ahead");
    assert_eq!(limit_mps(person((-1.2, 0.0), (0.0, 0.0)), twist), None, "left behind");
    assert_eq!(limit_mps(person((-1.2, 0.0), (0.0, 0.0)), driving(-0.2, 0.0)), Some(0.3), "backing");
}

#[test]
fn fg_req_009_stop_for_a_person_ends_after_four_sweeps() {
    assert_eq!(Cause::CollisionStop.clear(), Clear::Quiet(PERSON_QUIET_US));
    assert!(PERSON_QUIET_US >= 400_000 && Cause::ScanProtective.clear() == Clear::Quiet(1_000_000));
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(2_000))]

    /// Whoever is left out of the rule would walk into the standing robot, and is met by no point of the body that comes nearer by
    /// the robot's own motion.
    #[test]
    fn fg_req_038_left_out_walkers_meet_the_standing_robot(
        (linear_mps, angular_radps) in (0.05_f32..1.0, prop_oneof![Just(0.0_f32), -0.2_f32..0.2]),
        (x_m, y_m) in (-3.0_f32..-0.5, -0.9_f32..0.9),
        (x_mps, y_mps) in (0.2_f32..1.6, -0.3_f32..0.3),
        (sigma_m, more_m) in (0.0_f32..0.1, 0.0_f32..0.5),
    ) {
        let body = Body::around(&config().footprint);
        let twist = driving(linear_mps, angular_radps);
        let walker = AdvisedPerson { position_sigma_m: sigma_m, ..person((x_m, y_m), (x_mps, y_mps)) };
        prop_assume!(body.is_met_from_behind(&walker, twist));
        let still = AdvisedPerson { velocity_mps: Point2::default(), ..walker };
        prop_assert!(body.recedes_from(&still, twist), "its own motion comes nearer");
        let gaps_m = (0..8_000).map(|step| {
            let time_s = 0.005 * step as f32;
            body.distance_m(Point2::new(x_m + x_mps * time_s, y_m + y_mps * time_s))
        });
        let least_m = gaps_m.fold(f32::INFINITY, f32::min);
        prop_assert!(least_m <= 0.32, "{least_m} m from the standing robot");
        let doubtful = AdvisedPerson { position_sigma_m: sigma_m + more_m, ..walker };
        let certain = AdvisedPerson { position_sigma_m: 0.0, ..walker };
        prop_assert!(body.is_met_from_behind(&certain, twist) || !body.is_met_from_behind(&doubtful, twist));
    }
}
