//! Decisions at exactly their limits: neither side may move by the width of a number.

use super::fixtures::{Rig, forward};
use crate::protection::CauseRecord;
use crate::*;
use floorguard_types::geometry::{Point2, Twist2};

const FAR: f32 = f32::INFINITY;

/// Whether a cause holds after people were judged, for a robot that has just started and stands.
fn judged(people: (f32, [f32; 2], f32), cause: Cause) -> Option<CauseRecord> {
    let mut rig = Rig::cruising();
    let now = rig.now;
    rig.guard.judge_people(people, 0, now);
    rig.guard.causes().find(|record| record.cause == cause).copied()
}

fn below(limit: f32) -> f32 {
    limit.next_down()
}

#[test]
fn fg_req_031_people_count_only_below_their_limits() {
    let near_m = super::fixtures::config().thresholds.person_near_m;
    let near = |distance_m| judged((distance_m, [FAR; 2], 0.0), Cause::PersonNear);
    assert!(near(near_m).is_none() && near(below(near_m)).is_some());
    // Response, nothing to brake, margin.
    let stop_s = 0.15_f32 + 0.0 / 0.8 + 0.5;
    let stops = |time_s| judged((FAR, [time_s; 2], 0.0), Cause::CollisionStop);
    assert!(stops(stop_s).is_none() && stops(below(stop_s)).is_some());
    let slows = |time_s| judged((FAR, [time_s; 2], 0.0), Cause::CollisionSlow);
    assert!(slows(3.0).is_none() && slows(below(3.0)).is_some());
}

#[test]
fn fg_req_031_touching_begins_below_three_tenths_of_a_metre() {
    // The front edge lies at 0.95 m; these distances are exact in binary.
    for (x_m, touches) in [(1.25_f32, false), (1.25_f32.next_down(), true)] {
        let mut rig = Rig::cruising();
        (rig.measured, rig.wanted) = (Twist2::ZERO, Twist2::ZERO);
        rig.run_ms(200);
        let position = Point2::new(x_m, 0.0);
        let distance_m = rig.guard.body.distance_m(position);
        assert_eq!(distance_m < 0.3, touches, "{distance_m}");
        let person = AdvisedPerson { position, ..AdvisedPerson::default() };
        let people = [person].into_iter().collect();
        rig.guard.on_advice(&Advice { stamp: rig.now, people, ..Advice::default() }, rig.now);
        let stops = rig.guard.causes().any(|record| record.cause == Cause::CollisionStop);
        assert_eq!(stops, touches, "{x_m}");
    }
}

#[test]
fn fg_req_001_robot_moves_at_five_centimetres_per_second() {
    for (speed_mps, torque_off) in [(0.05, false), (below(0.05), true)] {
        let mut rig = Rig::cruising();
        rig.guard.state.machine.raise(CauseRecord::new(Cause::Overspeed, rig.now));
        rig.guard.copy = rig.guard.state;
        let decision = rig.guard.on_wheels(forward(speed_mps), rig.now, rig.now);
        assert_eq!((decision.action, decision.torque_off), (Action::Category1, torque_off), "{speed_mps}");
    }
}
