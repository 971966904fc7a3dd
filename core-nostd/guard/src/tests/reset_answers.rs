//! What is shown of an emergency stop and of the resets after it.

use super::fixtures::Rig;
use crate::*;
use floorguard_types::sensing::{DriveFeedback, DriveState, SafetyInput};

#[test]
fn fg_req_071_pressed_emergency_stop_is_shown_first() {
    let of = |record: Option<CauseRecord>| record.map(|record| record.cause);
    let mut rig = Rig::cruising();
    rig.inputs.emergency_stop = SafetyInput::Active;
    rig.run_ms(100);
    // The drive loses its power with the emergency stop, and reports that as a fault, with newer evidence.
    let fault =
        DriveFeedback { stamp: rig.now, state: DriveState::Fault(0x5441), ..DriveFeedback::default() };
    let decision = rig.guard.on_drive(&fault, rig.now);
    assert_eq!(of(decision.holding_cause), Some(Cause::EmergencyStop), "{decision:?}");
    rig.inputs.emergency_stop = SafetyInput::Clear;
    rig.run_ms(300);
    let fault = DriveFeedback { stamp: rig.now, ..fault };
    let decision = rig.guard.on_drive(&fault, rig.now);
    assert_eq!(of(decision.holding_cause), Some(Cause::DriveFault), "{decision:?}");
}

#[test]
fn fg_req_072_refused_reset_names_its_reason() {
    let mut rig = Rig::cruising();
    rig.inputs.emergency_stop = SafetyInput::Active;
    rig.run_ms(1_000);
    assert_eq!(rig.guard.resets(), ResetReport::default());
    rig.guard.request_reset(rig.now);
    rig.run_ms(500);
    let report = rig.guard.resets();
    assert_eq!((report.granted, report.refused), (0, 1));
    assert_eq!(report.refusal, Some(ResetRefusal::Present(Cause::EmergencyStop)));
    rig.inputs.emergency_stop = SafetyInput::Clear;
    rig.silent.push(Source::Lidar);
    rig.run_ms(1_000);
    rig.guard.request_reset(rig.now);
    rig.run_ms(500);
    let refusal = rig.guard.resets().refusal;
    assert!(matches!(refusal, Some(ResetRefusal::NotHealthy(Source::Lidar, _))), "{refusal:?}");
    rig.silent.clear();
    rig.run_ms(1_000);
    rig.guard.request_reset(rig.now);
    rig.run_ms(500);
    let report = rig.guard.resets();
    assert_eq!((report.granted, report.refused, report.refusal), (1, 2, None));
}
