//! More doubt about a person never means less protection.

use proptest::prelude::*;

use crate::tests::fixtures::{Rig, config};
use crate::*;
use floorguard_types::geometry::{Point2, Twist2};

/// How strongly a robot with this motion is held back by one person: the action, and the speed that is left, m/s.
fn protection(person: AdvisedPerson, twist: Twist2) -> (Action, f32) {
    let mut rig = Rig::with(config());
    rig.run_ms(1_500);
    rig.guard.on_wheels(twist, rig.now, rig.now);
    rig.guard.on_command(twist, rig.now, rig.now);
    let people = [person].into_iter().collect();
    rig.guard.on_advice(&Advice { stamp: rig.now, people, ..Advice::default() }, rig.now);
    let about_people =
        |cause| matches!(cause, Cause::PersonNear | Cause::CollisionStop | Cause::CollisionSlow);
    let held = rig.guard.causes().filter(|record| about_people(record.cause));
    held.fold((Action::None, f32::INFINITY), |(action, limit_mps), record| {
        let left_mps = if record.action.stops() { 0.0 } else { record.speed_limit_mps };
        (action.max(record.action), limit_mps.min(left_mps))
    })
}

/// 1.35 m ahead of the front edge, coming with 1.4 m/s towards a robot at 1 m/s.
#[test]
fn fg_req_033_approaching_person_stops_despite_doubt() {
    for sigma_m in [0.0, 0.05, 0.1, 0.2, 0.3, 0.5, 0.7, 2.0] {
        let person = AdvisedPerson {
            position: Point2::new(0.95 + 1.35, 0.0),
            velocity_mps: Point2::new(-1.4, 0.0),
            position_sigma_m: sigma_m,
            ..AdvisedPerson::default()
        };
        let (action, _) = protection(person, Twist2 { linear_mps: 1.0, angular_radps: 0.0 });
        assert_eq!(action, Action::Category2, "a doubt of {sigma_m} m");
    }
}

fn person() -> impl Strategy<Value = AdvisedPerson> {
    let position = (-3.0_f32..5.0, -3.0_f32..3.0);
    let velocity = (-2.0_f32..2.0, -2.0_f32..2.0);
    (position, velocity, 0.0_f32..0.8, 0.0_f32..0.8).prop_map(|(at, velocity, sigma_m, sigma_mps)| {
        AdvisedPerson {
            id: 1,
            position: Point2::new(at.0, at.1),
            velocity_mps: Point2::new(velocity.0, velocity.1),
            position_sigma_m: sigma_m,
            velocity_sigma_mps: sigma_mps,
        }
    })
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(4_000))]

    #[test]
    fn fg_req_033_times_to_people_never_grow_with_the_doubt(
        person in person(),
        (linear_mps, angular_radps) in (-0.5_f32..1.1, prop_oneof![Just(0.0_f32), -0.8_f32..0.8]),
        (more_m, more_mps) in (prop_oneof![Just(0.0_f32), 0.0_f32..1.5], prop_oneof![Just(0.0_f32), 0.0_f32..1.0]),
    ) {
        let body = Body::around(&config().footprint);
        let twist = Twist2 { linear_mps, angular_radps };
        let doubtful = AdvisedPerson {
            position_sigma_m: person.position_sigma_m + more_m,
            velocity_sigma_mps: person.velocity_sigma_mps + more_mps,
            ..person
        };
        let times_s = body.times_to_person_s(&person, twist);
        let later_s = body.times_to_person_s(&doubtful, twist);
        for (before_s, after_s) in times_s.into_iter().zip(later_s) {
            prop_assert!(after_s <= before_s + 1.0e-3, "{before_s} s became {after_s} s");
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(300))]

    #[test]
    fn fg_req_033_more_doubt_never_means_less_protection(
        person in person(),
        linear_mps in 0.1_f32..1.0,
        (more_m, more_mps) in (prop_oneof![Just(0.0_f32), 0.0_f32..1.5], prop_oneof![Just(0.0_f32), 0.0_f32..1.0]),
    ) {
        let twist = Twist2 { linear_mps, angular_radps: 0.0 };
        let doubtful = AdvisedPerson {
            position_sigma_m: person.position_sigma_m + more_m,
            velocity_sigma_mps: person.velocity_sigma_mps + more_mps,
            ..person
        };
        let (before, before_mps) = protection(person, twist);
        let (after, after_mps) = protection(doubtful, twist);
        prop_assert!(after >= before, "{before:?} became {after:?}");
        prop_assert!(after_mps <= before_mps + 1.0e-3, "{before_mps} m/s became {after_mps} m/s");
    }
}
