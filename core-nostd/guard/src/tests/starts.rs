//! Nothing moves without a start command: not after power-up, not after a reset, not with what was latched before.

use super::fixtures::Rig;
use crate::*;
use floorguard_types::geometry::Twist2;
use floorguard_types::sensing::SafetyInput;

/// A robot whose operator has not pressed anything yet.
fn untouched() -> Rig {
    let mut rig = Rig::new();
    rig.operator_starts = false;
    rig
}

#[test]
fn fg_req_019_route_needs_a_start_after_power_up() {
    let mut rig = untouched();
    for _ in 0..1_000 {
        assert_eq!(rig.step().permitted, Twist2::ZERO);
    }
    assert_eq!(rig.step().state, GuardState::AwaitsStart);
    rig.guard.request_start(rig.now);
    assert!(rig.run_ms(2_000).permitted.linear_mps > 0.5);
}

#[test]
fn fg_req_019_reset_and_start_are_two_acts() {
    let mut rig = Rig::cruising();
    rig.operator_starts = false;
    rig.inputs.emergency_stop = SafetyInput::Active;
    rig.run_ms(500);
    rig.inputs.emergency_stop = SafetyInput::Clear;
    rig.run_ms(500);
    // A start before the reset is none, and is not remembered.
    rig.guard.request_start(rig.now);
    assert_eq!(rig.run_ms(500).state, GuardState::Latched);
    rig.guard.request_reset(rig.now);
    let decision = rig.run_ms(5_000);
    assert_eq!((decision.state, decision.permitted), (GuardState::AwaitsStart, Twist2::ZERO), "{decision:?}");
    rig.guard.request_start(rig.now);
    assert!(rig.run_ms(2_000).permitted.linear_mps > 0.5);
}

#[test]
fn fg_req_019_start_before_healthy_sensors_is_void() {
    let mut rig = untouched();
    rig.silent.push(Source::Imu);
    rig.run_ms(500);
    rig.guard.request_start(rig.now);
    rig.silent.clear();
    assert_eq!(rig.run_ms(5_000).state, GuardState::AwaitsStart);
}

#[test]
fn fg_req_019_self_clearing_stop_needs_no_start() {
    let mut rig = Rig::cruising();
    rig.operator_starts = false;
    rig.silent.push(Source::Imu);
    rig.run_ms(500);
    rig.silent.clear();
    assert!(rig.run_ms(4_000).permitted.linear_mps > 0.5);
}

#[test]
fn fg_req_070_what_was_latched_is_latched_after_a_reboot() {
    for cause in Cause::all() {
        let mut rig = Rig::cruising();
        rig.guard.state.machine.raise(CauseRecord::new(cause, rig.now));
        rig.guard.copy = rig.guard.state;
        let latches = rig.guard.latches();
        let needs_reset = cause.clear() == Clear::Reset;
        assert_eq!(latches != 0, needs_reset, "{cause:?}");
        let mut after = untouched();
        after.guard.on_latches(latches, after.now);
        let decision = after.run_ms(3_000);
        assert_eq!(decision.state == GuardState::Latched, needs_reset, "{cause:?}");
        assert_eq!(after.guard.latches(), latches, "{cause:?}");
        if needs_reset {
            assert_eq!(decision.action, cause.action(), "{cause:?}");
            after.guard.request_start(after.now);
            assert_eq!(after.run_ms(500).state, GuardState::Latched, "{cause:?}: a start is no reset");
            after.guard.request_reset(after.now);
            assert_eq!(after.run_ms(1_000).state, GuardState::AwaitsStart, "{cause:?}");
            assert_eq!(after.guard.latches(), 0);
        }
    }
}

/// Whatever bits are read: no more than causes that need a reset, and no panic.
#[test]
fn fg_req_070_bits_that_mean_nothing_latch_nothing() {
    let mut rig = untouched();
    rig.guard.on_latches(u64::MAX, rig.now);
    assert!(rig.guard.causes().all(|record| record.cause.clear() != Clear::Restart));
    let latched = Cause::all().into_iter().filter(|cause| cause.clear() == Clear::Reset).count();
    assert_eq!(rig.guard.latches().count_ones() as usize, latched);
}

#[test]
fn fg_req_070_emergency_stop_keeps_its_configured_action() {
    let mut configured = super::fixtures::config();
    configured.thresholds.emergency_action = Action::Category1;
    let mut rig = Rig::with(configured);
    rig.guard.on_latches(1 << Cause::EmergencyStop.index(), rig.now);
    assert_eq!(rig.step().action, Action::Category1);
}
