//! Where creeping is enough, and how people near limit the speed.

use crate::rules::PERSON_QUIET_US;
use crate::tests::fixtures::{Rig, config, met};
use crate::*;
use floorguard_types::geometry::{Point2, Twist2};
use floorguard_types::random::Pcg32;

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

fn record(rig: &Rig, cause: Cause) -> Option<CauseRecord> {
    rig.guard.causes().find(|record| record.cause == cause).copied()
}

fn stops(person: AdvisedPerson, twist: Twist2) -> bool {
    record(&met(person, twist), Cause::CollisionStop).is_some()
}

/// A robot that drove on before somebody who overtook it was walked into at its rear, which a robot that stopped was not: who comes from
/// behind, or towards the flank, stops the robot as early as who comes from ahead.
#[test]
fn fg_req_032_walker_from_any_side_meets_a_stand() {
    let body = Body::around(&config().footprint);
    let twist = driving(0.3, 0.0);
    let needed_s = config().drive.clear_of_people_s(0.3);
    let walkers = [((-0.45, 0.1), (-1.0, 0.0)), ((0.0, 0.4), (0.0, 1.0)), ((0.95, 0.1), (1.0, 0.0))];
    for ((x_m, y_m), (away_x, away_y)) in walkers {
        for step in 0..60 {
            let far_m = 0.35 + 0.05 * step as f32;
            let place = (x_m + away_x * far_m, y_m + away_y * far_m);
            let walker = person(place, (-1.6 * away_x, -1.6 * away_y));
            let [soonest_s, _] = body.times_to_person_s(&walker, twist);
            let rig = met(walker, twist);
            let stands = record(&rig, Cause::CollisionStop).is_some();
            // A creep is enough while it leaves the time to stand from it (FG-REQ-039).
            let creep_mps = record(&rig, Cause::CollisionSlow).map_or(0.3, |slow| slow.speed_limit_mps);
            let [then_s, _] = body.times_to_person_s(&walker, driving(creep_mps, 0.0));
            let creeps = creep_mps < 0.3 && then_s >= config().drive.clear_of_people_s(creep_mps);
            assert!(soonest_s >= needed_s - 0.25 || stands || creeps, "{place:?} in {soonest_s} s");
        }
    }
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

/// Where the robot creeps instead of stopping, nobody is nearer than the radius of a person, 0.3 m less a centimetre, before it stands, should it have to stop from the creep: by true
/// geometry, in small steps, after its response time.
#[test]
fn fg_req_039_creep_leaves_time_to_stand() {
    let (body, drive) = (Body::around(&config().footprint), config().drive);
    let mut random = Pcg32::new(39, 1);
    let mut creeps = 0;
    for _ in 0..6_000 {
        let mut between = |low: f32, high: f32| random.uniform_between(low, high);
        let linear_mps = between(0.1, 1.0);
        let ((x_m, y_m), (x_mps, y_mps)) =
            ((between(-3.0, 4.0), between(-2.0, 2.0)), (between(-1.6, 1.6), between(-1.6, 1.6)));
        let twist = driving(linear_mps, 0.0);
        let walker = AdvisedPerson { position_sigma_m: 0.0, ..person((x_m, y_m), (x_mps, y_mps)) };
        let [soonest_s, _] = body.times_to_person_s(&walker, twist);
        if soonest_s >= drive.clear_of_people_s(linear_mps) || body.recedes_from(&walker, twist) {
            continue;
        }
        let rig = met(walker, twist);
        if record(&rig, Cause::CollisionStop).is_some() {
            continue;
        }
        creeps += 1;
        let creep_mps = record(&rig, Cause::CollisionSlow).expect("slows").speed_limit_mps;
        assert!(creep_mps < linear_mps && creep_mps <= 0.3 + 1.0e-6, "{creep_mps}");
        let (mut robot_m, mut speed_mps) = (0.0_f32, linear_mps);
        for step in 0..4_000 {
            let time_s = 0.001 * step as f32;
            let gap_m = body.distance_m(Point2::new(x_m + x_mps * time_s - robot_m, y_m + y_mps * time_s));
            if speed_mps <= 0.0 {
                break;
            }
            assert!(gap_m > 0.29, "{gap_m} m after {time_s} s at {speed_mps} m/s: {walker:?} {twist:?}");
            if time_s > drive.response_s {
                speed_mps -= drive.braking_mps2 * 0.001;
            }
            robot_m += speed_mps * 0.001;
        }
    }
    assert!(creeps > 50, "{creeps} creeps");
}

/// The stop that perception's broken numbers raise must not be the only one: they permit no creep.
#[test]
fn fg_req_039_broken_numbers_permit_no_creep() {
    let body = Body::around(&config().footprint);
    let far = person((30.0, 0.0), (0.0, 0.0));
    let creep = |person: AdvisedPerson| {
        PeopleFinding::of((&body, &config()), &[person], (driving(0.5, 0.0), 0.5)).creep_mps
    };
    assert_eq!(creep(far), Some(0.3));
    let broken = [
        AdvisedPerson { position: Point2::new(f32::NAN, 0.0), ..far },
        AdvisedPerson { position: Point2::new(30.0, f32::INFINITY), ..far },
        AdvisedPerson { velocity_mps: Point2::new(f32::NAN, 0.0), ..far },
        AdvisedPerson { position_sigma_m: f32::NAN, ..far },
        AdvisedPerson { velocity_sigma_mps: f32::NAN, ..far },
    ];
    for person in broken {
        assert_eq!(creep(person), None, "{person:?}");
    }
}
