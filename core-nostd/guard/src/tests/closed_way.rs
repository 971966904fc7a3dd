//! What was seen near the body and is out of every sensor's sight holds the robot until a person has looked there.

use super::fixtures::{Rig, forward};
use crate::*;
use floorguard_types::geometry::{Point2, Twist2};
use floorguard_types::sensing::SafetyInput;

/// Places ahead of the body, in the robot's frame.
const AHEAD: [Point2; 3] = [Point2::new(1.1, -0.07), Point2::new(1.1, 0.0), Point2::new(1.1, 0.07)];

/// Something stands ahead, as a sensor would have entered it.
fn see_ahead(rig: &mut Rig) {
    let pose = rig.guard.memory.pose();
    AHEAD.iter().for_each(|place| rig.guard.memory.set_scanned(Cell::of(pose.transform(*place)), true));
}

/// A robot that stands before what it remembers; no sensor looks there any more.
fn held() -> Rig {
    let mut rig = Rig::new();
    rig.run_ms(1_000);
    see_ahead(&mut rig);
    rig.run_ms(3_000);
    rig.measured = Twist2::ZERO;
    // Where it stands now.
    see_ahead(&mut rig);
    assert_eq!(holding(&rig.run_ms(2_000)), Some(Cause::WayClosed));
    rig
}

fn holding(decision: &Decision) -> Option<Cause> {
    decision.holding_cause.map(|record| record.cause)
}

#[test]
fn fg_req_065_time_alone_opens_no_way() {
    let mut rig = held();
    for _ in 0..60_000 / 10 {
        let decision = rig.step();
        assert_eq!((holding(&decision), decision.permitted), (Some(Cause::WayClosed), Twist2::ZERO));
    }
}

#[test]
fn fg_req_065_granted_reset_and_start_open_the_way() {
    let mut rig = held();
    rig.operator_starts = false;
    rig.guard.request_reset(rig.now);
    // The reset is granted, and the sensors enter anew what they see.
    for _ in 0..10_000 / 10 {
        assert_eq!(rig.step().permitted, Twist2::ZERO, "a reset is no start");
    }
    assert_eq!(rig.step().state, GuardState::AwaitsStart);
    rig.guard.request_start(rig.now);
    let decision = rig.run_ms(3_000);
    assert!(decision.permitted.linear_mps > 0.5, "{decision:?}");
}

#[test]
fn fg_req_065_start_waits_until_sensors_have_looked() {
    let mut rig = held();
    rig.guard.request_reset(rig.now);
    let moves_ms = rig.until(|decision| decision.permitted != Twist2::ZERO);
    assert_eq!((moves_ms, rig.guard.resets().granted), (None, 1), "it stands for two seconds more");
    // The object is still there: the sensors meet it again.
    see_ahead(&mut rig);
    for _ in 0..30_000 / 10 {
        let decision = rig.step();
        assert_eq!((holding(&decision), decision.permitted), (Some(Cause::WayClosed), Twist2::ZERO));
    }
}

#[test]
fn fg_req_065_reset_of_a_latch_keeps_the_memory() {
    let mut rig = held();
    rig.inputs.emergency_stop = SafetyInput::Active;
    rig.run_ms(500);
    rig.inputs.emergency_stop = SafetyInput::Clear;
    rig.run_ms(500);
    rig.guard.request_reset(rig.now);
    let decision = rig.run_ms(10_000);
    assert_eq!((rig.guard.resets().granted, holding(&decision)), (1, Some(Cause::WayClosed)), "{decision:?}");
    rig.guard.request_reset(rig.now);
    let decision = rig.run_ms(10_000);
    assert!(decision.permitted.linear_mps > 0.5, "{decision:?}");
}

#[test]
fn fg_req_065_refused_reset_opens_nothing() {
    let mut rig = held();
    rig.silent.push(Source::Imu);
    rig.run_ms(500);
    rig.guard.request_reset(rig.now);
    rig.run_ms(1_000);
    rig.silent.clear();
    let decision = rig.run_ms(10_000);
    assert_eq!((rig.guard.resets().granted, holding(&decision)), (0, Some(Cause::WayClosed)), "{decision:?}");
}

/// Without the rule: a way that is narrow, and no stop, is not forgotten by a reset.
#[test]
fn fg_req_065_reset_of_an_open_way_keeps_it() {
    let mut rig = Rig::new();
    rig.wanted = Twist2::ZERO;
    rig.run_ms(2_000);
    see_ahead(&mut rig);
    rig.guard.request_reset(rig.now);
    rig.run_ms(1_000);
    assert_eq!(rig.guard.resets().granted, 1);
    let mut cells = 0;
    rig.guard.memory.for_each(|_| cells += 1);
    assert!(cells >= 2, "{cells}");
}

/// At a crawl a difference of one encoder tick between the wheels is noise: the robot may back away from an object 5 cm beside it. A real
/// turn stops it.
#[test]
fn fg_req_027_noise_of_encoders_is_no_curve() {
    let beside = |turns_radps: f32| {
        let mut rig = Rig::new();
        rig.wanted = Twist2::ZERO;
        rig.run_ms(2_000);
        let pose = rig.guard.memory.pose();
        for x_m in [0.7, 0.75, 0.8] {
            let place = pose.transform(Point2::new(x_m, 0.42));
            rig.guard.memory.set_scanned(Cell::of(place), true);
        }
        rig.wanted = forward(-0.2);
        let measured = Twist2 { linear_mps: -0.06, angular_radps: turns_radps };
        rig.measured = measured;
        rig.guard.on_wheels(measured, rig.now, rig.now);
        holding(&rig.guard.tick(rig.now.plus_micros(10_000)))
    };
    assert_eq!(beside(0.0), beside(0.01));
    assert_ne!(beside(0.01), Some(Cause::WayClosed));
    assert_eq!(beside(0.1), Some(Cause::WayClosed));
}

#[test]
fn fg_req_058_corrupted_value_of_a_task_needs_a_restart() {
    let mut rig = Rig::cruising();
    let decision = rig.guard.on_corruption(rig.now);
    assert_eq!((decision.action, decision.torque_off), (Action::Category0, true));
    assert_eq!(holding(&decision), Some(Cause::StateCorrupted));
    rig.run_ms(1_000);
    rig.guard.request_reset(rig.now);
    let decision = rig.run_ms(5_000);
    assert_eq!((decision.state, decision.permitted), (GuardState::Latched, Twist2::ZERO), "{decision:?}");
}
