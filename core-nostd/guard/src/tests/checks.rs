//! Motion checks, decision machine and inputs at their borders, and what each number of them is good for.

use super::fixtures::{Rig, config, forward, packet};
use crate::limiter::limited;
use crate::machine::DecisionMachine;
use crate::motion_checks::MotionChecks;
use crate::packet_check::BLIND_RUN_CDEG;
use crate::protection::{CauseRecord, FaultKind, HeldCauses};
use crate::rules::Clear;
use crate::*;
use floorguard_types::geometry::Twist2;
use floorguard_types::sensing::{DriveFeedback, DriveState, ImuSample, LidarColumn};
use floorguard_types::time::Stamp;

const NOW: Stamp = Stamp::from_micros(10_000_000);

/// Causes of a motion that lasts for a second.
fn lasting(motion: Motion, envelope_mps: f32) -> std::vec::Vec<CauseRecord> {
    let mut checks = MotionChecks { envelope_mps, ..MotionChecks::default() };
    let config = config();
    checks.check(&motion, &config, NOW);
    checks.check(&motion, &config, NOW.plus_micros(1_000_000)).into_iter().flatten().collect()
}

fn causes(motion: Motion, envelope_mps: f32) -> std::vec::Vec<Cause> {
    lasting(motion, envelope_mps).iter().map(|record| record.cause).collect()
}

/// As encoders, gyroscope and drive tell it.
fn moving(wheels: Twist2, gyro_radps: f32, (drive_mps, steering_rad): (f32, f32)) -> Motion {
    let (config, mut motion) = (config(), Motion { gyro_radps, ..Motion::STILL });
    motion.hear_wheels(wheels, &config.footprint);
    motion.hear_drive(drive_mps, steering_rad, &config);
    motion
}

fn turning(linear_mps: f32, angular_radps: f32) -> Twist2 {
    Twist2 { linear_mps, angular_radps }
}

#[test]
fn fg_req_051_agreeing_sensors_raise_no_cause() {
    let wheelbase_m = config().drive.wheelbase_m;
    for degrees in [-75.0_f32, -40.0, 0.0, 20.0, 60.0, 85.0] {
        let steering_rad = degrees.to_radians();
        let (sin, cos) = steering_rad.sin_cos();
        for drive_mps in [-0.6_f32, 0.2, 0.9] {
            let turn_radps = drive_mps * sin / wheelbase_m;
            let wheels = turning(drive_mps * cos, turn_radps);
            let motion = moving(wheels, turn_radps, (drive_mps, steering_rad));
            assert_eq!(causes(motion, 1.5), [], "{degrees}° {drive_mps}");
            let slower = Motion { wheels: turning(wheels.linear_mps - 0.3, turn_radps), ..motion };
            assert!(causes(slower, 1.5).contains(&Cause::SpeedDisagreement), "{degrees}° {drive_mps}");
            let gyro = Motion { gyro_radps: turn_radps - 0.4, ..motion };
            assert_eq!(causes(gyro, 1.5), [Cause::TurnDisagreement]);
        }
    }
}

#[test]
fn fg_req_053_slip_is_difference_to_steering_and_drive() {
    // 0.8 m wheelbase, a right angle: the whole speed of the driven wheel turns the robot.
    let steering_rad = core::f32::consts::FRAC_PI_2;
    let motion = |turn_radps: f32| moving(turning(0.0, turn_radps), turn_radps, (0.4, steering_rad));
    assert_eq!((causes(motion(0.5), 1.0), causes(motion(0.75), 1.0)), (std::vec![], std::vec![]));
    let records = lasting(motion(0.1), 1.0);
    assert_eq!(records.len(), 1);
    assert!((records[0].measured - 0.4).abs() < 1.0e-5 && records[0].limit == 0.3, "{records:?}");
    assert_eq!(causes(motion(0.9), 1.0), [Cause::SteeringDisagreement]);
}

#[test]
fn fg_req_050_a_difference_at_its_limit_is_tolerated() {
    let still = Motion::default();
    let speed = |mps: f32| causes(Motion { wheels: forward(mps), ..still }, 1.0);
    assert_eq!((speed(0.25), speed(0.25_f32.next_up())), (std::vec![], std::vec![Cause::SpeedDisagreement]));
    let gyro = |radps: f32| causes(Motion { gyro_radps: radps, ..still }, 1.0);
    assert_eq!((gyro(0.3), gyro(0.3_f32.next_up())), (std::vec![], std::vec![Cause::TurnDisagreement]));
    let steering =
        |radps: f32| causes(Motion { wheels: turning(0.0, radps), gyro_radps: radps, ..still }, 1.0);
    assert_eq!(
        (steering(0.3), steering(0.3_f32.next_up())),
        (std::vec![], std::vec![Cause::SteeringDisagreement])
    );
    let limit_mps = 1.1_f32 * 0.5 + 0.05;
    let fast = |mps: f32| causes(moving(forward(mps), 0.0, (mps, 0.0)), 0.5);
    assert_eq!((fast(limit_mps), fast(limit_mps.next_up())), (std::vec![], std::vec![Cause::Overspeed]));
}

#[test]
fn fg_req_009_quiet_is_over_at_its_microsecond() {
    for (cause, quiet_us) in [(Cause::Warning, 500_000), (Cause::ScanProtective, 1_000_000)] {
        let holds = |after_us: u64| {
            let mut machine = DecisionMachine::new(Stamp::from_micros(1_000_000));
            machine.raise(CauseRecord::new(cause, NOW));
            machine.settle(true, NOW.plus_micros(after_us));
            machine.holds(cause)
        };
        assert!(holds(quiet_us - 1) && !holds(quiet_us), "{cause:?}");
    }
}

#[test]
fn fg_req_005_request_is_granted_once_unless_evidence_cancels() {
    let at = |ms: u64| NOW.plus_micros(ms * 1_000);
    let mut machine = DecisionMachine::new(at(0));
    machine.raise(CauseRecord::new(Cause::EmergencyStop, at(0)));
    machine.request_reset(at(1_000));
    let verdict = machine.settle(true, at(1_400));
    assert_eq!((verdict.action, verdict.state), (Action::Category2, GuardState::AwaitsStart));
    machine.request_start();
    assert_eq!(machine.settle(true, at(1_400)).action, Action::None);
    for ms in [1_500, 2_500, 3_500] {
        machine.settle(true, at(ms));
        assert_eq!((machine.resets(), machine.reset_since), (1, None));
    }
    let mut machine = DecisionMachine::new(at(0));
    machine.request_reset(at(1_000));
    machine.raise(CauseRecord::new(Cause::EmergencyStop, at(1_050)));
    machine.settle(true, at(1_100));
    assert_eq!(machine.reset_since, None, "evidence cancels");
    machine.request_reset(at(2_000));
    machine.settle(false, at(2_100));
    assert_eq!(machine.reset_since, None, "a failed self-test cancels");
    machine.settle(true, at(3_000));
    assert_eq!(machine.resets(), 0);
    assert_eq!(Cause::StateCorrupted.clear(), Clear::Restart);
}

#[test]
fn fg_req_006_turning_continues_from_its_speed() {
    let drive = config().drive;
    let wanted = turning(0.0, 0.5);
    for previous_mps in [-0.5, 0.5] {
        assert_eq!(limited(wanted, 1.0, &drive, (forward(previous_mps), 0.1)), wanted, "{previous_mps}");
    }
    assert_eq!(limited(wanted, 0.0, &drive, (wanted, 0.1)), Twist2::ZERO);
    assert_eq!(limited(Twist2::ZERO, 1.0, &drive, (wanted, 0.1)), Twist2::ZERO);
}

#[test]
fn fg_req_016_lidar_silence_becomes_blindness_until_a_return() {
    let silent_packet = |rig: &Rig| {
        let mut silent = packet(rig.now, 0, 10.0);
        silent.columns = [0, 100]
            .map(|azimuth_cdeg| LidarColumn { azimuth_cdeg, ..LidarColumn::SILENT })
            .into_iter()
            .collect();
        silent
    };
    let is_blind = |rig: &Rig| rig.guard.state.monitors[Source::Lidar.index()].blind;
    let mut rig = Rig::cruising();
    // 100 and the last column's own 20.
    for (before, blind) in [(BLIND_RUN_CDEG - 120, false), (BLIND_RUN_CDEG - 119, true)] {
        rig.guard.state.silent_cdeg = before;
        rig.guard.copy = rig.guard.state;
        let silent = silent_packet(&rig);
        rig.guard.on_lidar_packet(&silent, rig.now);
        assert_eq!((rig.guard.state.silent_cdeg, is_blind(&rig)), (before + 120, blind));
    }
    rig.guard.on_lidar_packet(&packet(rig.now, 0, 10.0), rig.now);
    assert_eq!((rig.guard.state.silent_cdeg, is_blind(&rig)), (0, false));
}

#[test]
fn fg_req_015_every_inertial_bit_counts_against_frozen() {
    let sample = ImuSample {
        stamp: NOW,
        angular_radps: [0.11, -0.07, 0.013],
        linear_mps2: [0.37, -0.21, 9.803],
        ..ImuSample::default()
    };
    let fingerprint = |sample: &ImuSample| {
        let mut rig = Rig::new();
        rig.guard.on_imu(sample, NOW);
        rig.guard.state.monitors[Source::Imu.index()].fingerprint
    };
    let before = fingerprint(&sample);
    for bit in 0..23 {
        for axis in 0..3 {
            let flipped = |number: f32| f32::from_bits(number.to_bits() ^ (1 << bit));
            let mut other = sample;
            other.angular_radps[axis] = flipped(other.angular_radps[axis]);
            assert_ne!(fingerprint(&other), before, "rate {axis} bit {bit}");
            let mut other = sample;
            other.linear_mps2[axis] = flipped(other.linear_mps2[axis]);
            assert_ne!(fingerprint(&other), before, "acceleration {axis} bit {bit}");
        }
    }
}

#[test]
fn fg_req_010_one_bad_number_is_a_fault() {
    let fault = |rig: &Rig, source: Source| rig.guard.state.monitors[source.index()].fault;
    let good = ImuSample { stamp: NOW, angular_radps: [0.0, 0.0, 0.2], ..ImuSample::default() };
    let mut rig = Rig::new();
    rig.guard.on_imu(&good, NOW);
    assert_eq!((fault(&rig, Source::Imu), rig.guard.state.motion.gyro_radps), (None, 0.2));
    let suspect = ImuSample { suspect: true, angular_radps: [0.0, 0.0, 0.3], ..good };
    let broken = ImuSample { linear_mps2: [0.0, f32::NAN, 0.0], angular_radps: [0.0, 0.0, 0.3], ..good };
    for bad in [suspect, broken] {
        let mut rig = Rig::new();
        rig.guard.on_imu(&good, NOW);
        rig.guard.on_imu(&bad, NOW);
        assert_eq!(fault(&rig, Source::Imu), Some(FaultKind::Garbled), "{bad:?}");
        assert_eq!(rig.guard.state.motion.gyro_radps, 0.2);
    }
    for (wheel_speed_mps, steering_rad) in [(f32::NAN, 0.1), (0.4, f32::INFINITY)] {
        let mut rig = Rig::new();
        let state = DriveState::Enabled;
        rig.guard.on_drive(&DriveFeedback { stamp: NOW, state, wheel_speed_mps, steering_rad }, NOW);
        assert_eq!(fault(&rig, Source::Drive), Some(FaultKind::Garbled));
        assert_eq!(rig.guard.state.motion.drive, Twist2::ZERO);
    }
}

#[test]
fn fg_req_054_command_must_be_finite_and_not_future() {
    let wanted = |twist: Twist2, stamp: Stamp| {
        let mut rig = Rig::cruising();
        let now = rig.now;
        let stamp = if stamp == Stamp::ZERO { now } else { now.plus_micros(3_000_000) };
        rig.guard.on_command(twist, stamp, now);
        rig.guard.state.wanted
    };
    assert_eq!(wanted(forward(0.4), Stamp::ZERO), forward(0.4));
    assert_eq!(wanted(forward(f32::NAN), Stamp::ZERO), Twist2::ZERO);
    assert_eq!(wanted(forward(0.4), NOW), Twist2::ZERO, "stamped in the future");
}

#[test]
fn fg_req_004_held_causes_keep_first_record_and_copy() {
    let all = Cause::all();
    let record = |cause, ms: u64, limit_mps| {
        CauseRecord::new(cause, NOW.plus_micros(ms * 1_000)).limited_to(limit_mps)
    };
    for cause in all {
        let mut held = HeldCauses::new();
        assert!(!held.holds(cause) && held.iter().count() == 0);
        held.pulse(record(cause, 0, 0.3));
        held.pulse(record(cause, 5, 0.2));
        let only: std::vec::Vec<_> = held.iter().collect();
        assert_eq!((only.len(), only[0].first, only[0].limit_mps), (1, record(cause, 0, 0.3), 0.2));
        assert_eq!(only[0].last_pulse, NOW.plus_micros(5_000));
        assert!(all.into_iter().all(|other| held.holds(other) == (other == cause)));
        let mut copy = HeldCauses::new();
        assert!(copy != held);
        copy.follow(&held);
        assert!(copy == held);
        copy.pulse(record(cause, 6, 0.2));
        assert!(copy != held, "the newest evidence differs");
        held.retain(|_| false);
        assert!(held.iter().count() == 0 && held == HeldCauses::new());
        // It begins anew.
        held.pulse(record(cause, 9, 0.1));
        assert_eq!(held.iter().next().map(|slot| slot.first), Some(record(cause, 9, 0.1)));
    }
    let mut held = HeldCauses::new();
    all.into_iter().for_each(|cause| held.pulse(record(cause, 0, 0.3)));
    assert!(held.iter().map(|slot| slot.first.cause).eq(all));
    held.retain(|slot| slot.first.cause.index() % 3 == 1);
    assert!(all.into_iter().all(|cause| held.holds(cause) == (cause.index() % 3 == 1)));
    // A bit that flipped on by itself does not lend its slot's old record to the next evidence.
    let mut flipped = HeldCauses::new();
    flipped.bits |= 1 << Cause::EmergencyStop.index();
    flipped.pulse(record(Cause::EmergencyStop, 3, 0.0));
    assert_eq!(flipped.iter().next().map(|slot| slot.first.cause), Some(Cause::EmergencyStop));
}
