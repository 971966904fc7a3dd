//! The guard over time: what holds the robot until somebody resets it, what is recorded, and what it does not accept.

use super::fixtures::{Rig, config, forward, rectangle};
use super::timelines::stopped;
use crate::*;
use floorguard_types::geometry::{Point2, Twist2};
use floorguard_types::sensing::{DriveState, SafetyInput};

#[test]
fn fg_req_003_latched_causes_need_reset_and_self_test() {
    type Press = fn(&mut Rig);
    let presses: [(Press, Press, Cause); 5] = [
        (|rig| rig.inputs.emergency_stop = SafetyInput::Active, |_| (), Cause::EmergencyStop),
        (|rig| rig.inputs.bumper_front = SafetyInput::Active, |_| (), Cause::BumperFront),
        (|rig| rig.inputs.cliff_rear = SafetyInput::Fault, |_| (), Cause::InputFault),
        (|rig| rig.inputs.emergency_stop = SafetyInput::Unknown, |_| (), Cause::InputUnknown),
        (|rig| rig.drive_state = DriveState::Fault(0x7305), |_| (), Cause::DriveFault),
    ];
    for (press, _, cause) in presses {
        let mut rig = Rig::cruising();
        press(&mut rig);
        assert!(rig.until(stopped).unwrap() <= 20);
        // While it is pressed no reset helps.
        rig.guard.request_reset(rig.now);
        assert_eq!(rig.run_ms(1_000).state, GuardState::Latched);
        rig.inputs = floorguard_types::sensing::DiscreteInputs::all_clear(rig.now);
        rig.drive_state = DriveState::Enabled;
        let decision = rig.run_ms(5_000);
        assert_eq!((decision.state, decision.primary_cause.unwrap().cause), (GuardState::Latched, cause));
        assert!(stopped(&decision));
        // A lost source fails the self-test.
        rig.silent.push(Source::Imu);
        rig.run_ms(200);
        rig.guard.request_reset(rig.now);
        rig.silent.clear();
        assert_eq!(rig.run_ms(2_000).state, GuardState::Latched);
        rig.guard.request_reset(rig.now);
        assert!(rig.until(|decision| decision.permitted.linear_mps > 0.0).unwrap() >= 300);
    }
}

#[test]
fn fg_req_050_a_robot_that_does_not_brake_is_latched() {
    let mut rig = Rig::cruising();
    rig.silent.push(Source::Wheels);
    rig.wanted = Twist2::ZERO;
    for _ in 0..100 {
        rig.guard.on_wheels(forward(0.8), rig.now, rig.now);
        rig.step();
    }
    assert!(rig.guard.causes().any(|record| record.cause == Cause::Overspeed));
}

#[test]
fn fg_req_052_gyroscope_disagreement_latches_after_half_a_second() {
    let mut rig = Rig::cruising();
    rig.gyro_offset_radps = 0.4;
    let stopped_ms = rig.until(stopped).unwrap();
    assert!((490..=530).contains(&stopped_ms), "{stopped_ms}");
    assert_eq!(rig.step().primary_cause.unwrap().cause, Cause::TurnDisagreement);
}

#[test]
fn fg_req_051_encoders_against_drive_is_latched() {
    let mut rig = Rig::cruising();
    rig.silent.push(Source::Drive);
    for _ in 0..60 {
        rig.step();
        let feedback = floorguard_types::sensing::DriveFeedback {
            stamp: rig.now,
            state: DriveState::Enabled,
            wheel_speed_mps: 0.2,
            steering_rad: 0.0,
        };
        rig.guard.on_drive(&feedback, rig.now);
    }
    assert!(rig.guard.causes().any(|record| record.cause == Cause::SpeedDisagreement));
}

#[test]
fn fg_req_053_steering_against_encoders_holds_after_200_ms() {
    let mut rig = Rig::cruising();
    rig.silent.push(Source::Drive);
    for _ in 0..30 {
        rig.step();
        let feedback = floorguard_types::sensing::DriveFeedback {
            stamp: rig.now,
            state: DriveState::Enabled,
            wheel_speed_mps: 0.9,
            steering_rad: 0.45,
        };
        rig.guard.on_drive(&feedback, rig.now);
    }
    assert!(rig.guard.causes().any(|record| record.cause == Cause::SteeringDisagreement));
}

#[test]
fn fg_req_054_commands_that_are_no_numbers_stop() {
    for wrong in [f32::NAN, f32::INFINITY] {
        let mut rig = Rig::cruising();
        let decision = rig.guard.on_command(forward(wrong), rig.now, rig.now);
        assert!(stopped(&decision) && decision.primary_cause.unwrap().cause == Cause::CommandInvalid);
    }
}

#[test]
fn fg_req_004_first_stop_cause_is_never_overwritten() {
    let mut rig = Rig::cruising();
    rig.obstacles.push(Point2::new(1.1, 0.0));
    rig.until(stopped).unwrap();
    let first = rig.step().primary_cause.unwrap();
    rig.inputs.emergency_stop = SafetyInput::Active;
    rig.silent.push(Source::Lidar);
    let decision = rig.run_ms(1_000);
    assert_eq!(decision.primary_cause, Some(first));
    assert_eq!(decision.action, Action::Category0, "the most severe action, not the first, is taken");
    assert!(rig.guard.causes().count() >= 3);
}

#[test]
fn fg_req_071_present_and_first_causes_are_reported() {
    let of = |record: Option<CauseRecord>| record.map(|record| record.cause);
    // Somebody stands before the robot from power-up on.
    let mut rig = Rig::new();
    rig.obstacles.push(Point2::new(1.1, 0.0));
    let decision = rig.run_ms(20_000);
    assert_eq!(of(decision.primary_cause), Some(Cause::StartUp));
    assert_eq!(of(decision.holding_cause), Some(Cause::ScanProtective), "{decision:?}");
    // The more severe cause holds it, then the one that is still there, then the one that waits for the operator.
    rig.inputs.emergency_stop = SafetyInput::Active;
    assert_eq!(of(rig.run_ms(500).holding_cause), Some(Cause::EmergencyStop));
    rig.inputs.emergency_stop = SafetyInput::Clear;
    rig.run_ms(500);
    rig.operator_starts = false;
    rig.guard.request_reset(rig.now);
    assert_eq!(of(rig.run_ms(1_000).holding_cause), Some(Cause::ScanProtective));
    rig.obstacles.clear();
    let decision = rig.run_ms(2_000);
    assert_eq!(of(decision.holding_cause), Some(Cause::StartNeeded));
    assert_eq!(of(decision.primary_cause), Some(Cause::StartUp), "never overwritten");
    rig.guard.request_start(rig.now);
    let decision = rig.run_ms(3_000);
    assert_eq!((decision.primary_cause, decision.holding_cause), (None, None), "{decision:?}");
    rig.obstacles.push(Point2::new(3.0, 0.0));
    let decision = rig.run_ms(500);
    assert_eq!(of(decision.holding_cause), Some(Cause::Warning));
    assert_eq!(decision.primary_cause, decision.holding_cause);
}

#[test]
fn fg_req_007_stop_needs_no_command_and_no_tick() {
    let mut rig = Rig::cruising();
    rig.inputs.emergency_stop = SafetyInput::Active;
    rig.inputs.stamp = rig.now;
    let decision = rig.guard.on_discrete(&rig.inputs.clone(), rig.now);
    assert!(stopped(&decision) && decision.torque_off);
}

#[test]
fn fg_req_008_flipped_bit_or_backward_clock_is_detected() {
    let mut rig = Rig::cruising();
    rig.guard.state.started = false;
    let decision = rig.guard.tick(rig.now);
    assert!(stopped(&decision) && decision.action == Action::Category0);
    let mut rig = Rig::cruising();
    let decision = rig.guard.tick(rig.now.minus_micros(1));
    assert!(stopped(&decision) && decision.primary_cause.unwrap().cause == Cause::ClockFault);
}

#[test]
fn fg_req_060_inner_or_short_zone_is_refused() {
    let mut wrong = config();
    wrong.fields[0].protective = rectangle([-0.4, 1.25], 0.5);
    assert_eq!(wrong.validate(), Err(GuardConfigError::FieldInsideFootprint(0)));
    let mut wrong = config();
    wrong.fields[2].protective = rectangle([-0.45, 1.5], 0.5);
    assert!(matches!(wrong.validate(), Err(GuardConfigError::FieldTooShort { set: 2, .. })));
    let mut wrong = config();
    wrong.drive.braking_mps2 = f32::NAN;
    assert_eq!(wrong.validate(), Err(GuardConfigError::NotPositive("braking")));
    let mut wrong = config();
    wrong.sources[0].limit_after_us = 300_000;
    assert_eq!(wrong.validate(), Err(GuardConfigError::Deadline(Source::Scanner)));
}

/// A file of the evening is read in the morning, by another version perhaps.
#[test]
fn fg_req_070_no_cause_gets_another_bit() {
    let bits = [
        (Cause::EmergencyStop, 2),
        (Cause::InputFault, 3),
        (Cause::InputUnknown, 4),
        (Cause::BumperFront, 5),
        (Cause::BumperRear, 6),
        (Cause::CliffFront, 7),
        (Cause::CliffRear, 8),
        (Cause::Overspeed, 19),
        (Cause::SpeedDisagreement, 20),
        (Cause::TurnDisagreement, 21),
        (Cause::DriveFault, 23),
        (Cause::ClockFault, 24),
        (Cause::StateCorrupted, 25),
        (Cause::SourceLate(Source::ALL[0]), 26),
        (Cause::SourceLost(Source::ALL[7]), 41),
        (Cause::WayClosed, 42),
        (Cause::WayNarrow, 43),
        (Cause::StandstillLost, 44),
    ];
    for (cause, bit) in bits {
        assert_eq!((cause.index(), Cause::all()[bit]), (bit, cause));
    }
    assert!(Cause::all().into_iter().enumerate().all(|(index, cause)| cause.index() == index));
}
