//! Devices, cables and masters that fail or restart.

use super::*;

#[test]
fn silent_encoder_returns_without_a_jump() {
    let mut rig = Rig::new();
    rig.run(1.0);
    rig.drive(0.5, 0.0);
    rig.run(2.0);
    let before = rig.last_wheels();
    rig.muted = Some(3);
    rig.run(1.0);
    assert!(rig.events.contains(&BaseEvent::NodeLost(3)));
    assert!(!rig.base.is_complete());
    let silent_since = rig.last_wheels().stamp;
    assert!(silent_since.seconds_since(before.stamp) < 0.02, "one wheel alone is no sample");
    rig.muted = None;
    rig.run(1.5);
    assert!(rig.base.is_complete());
    let after = rig.last_wheels();
    let rolled = after.left_ticks.wrapping_sub(before.left_ticks);
    assert!(rolled > 0 && rolled < 20_000, "{rolled}");
}

/// Only the link from the drive to the master is broken: the master's heartbeat still reaches the drive, so that
/// its own watchdog stays quiet. The stop has to be sent although nobody answers.
#[test]
fn silent_drive_still_receives_stop_commands() {
    for deaf_s in [0.05, 1.0] {
        let mut rig = Rig::new();
        rig.run(1.0);
        rig.drive(0.5, 0.0);
        rig.run(2.0);
        rig.muted = Some(1);
        rig.run(deaf_s);
        rig.base.command(DriveCommand::Stop(StopKind::TorqueOff));
        rig.run(1.0);
        let speed_mps = rig.simulation.truth().twist.linear_mps;
        assert!(speed_mps.abs() < 0.01, "after {deaf_s} s of silence: {speed_mps}");
    }
}

/// Some other master, or a service tool, takes the drive out of operation, or restarts its communication. Process data
/// do not reach it any more while it is configured anew, and its power stage may still be on.
#[test]
fn drive_taken_out_of_operation_is_reported() {
    for command in [0x80, 0x82] {
        let mut rig = Rig::new();
        rig.run(1.0);
        rig.drive(0.5, 0.0);
        rig.run(2.0);
        rig.deliver(&[CanFrame::standard(0x000, &[command, 1])]);
        rig.run(0.02);
        rig.base.command(DriveCommand::Stop(StopKind::TorqueOff));
        rig.run(0.6);
        let speed_mps = rig.simulation.truth().twist.linear_mps;
        assert!(speed_mps.abs() < 0.01, "{command:02X}: {speed_mps}");
        assert!(rig.events.contains(&BaseEvent::NodeLost(1)), "{command:02X}");
        assert_eq!(rig.base.counters().losses, 1, "{command:02X}");
        rig.run(1.0);
        assert!(rig.base.is_complete(), "{command:02X}");
    }
}

/// A device that restarts in the middle of its configuration has forgotten the first half of it.
#[test]
fn restarted_device_is_configured_from_the_start() {
    let mut rig = Rig::new();
    rig.run(0.08);
    assert!(!rig.base.is_complete());
    rig.deliver(&[CanFrame::standard(0x000, &[0x82, 0])]);
    rig.run(1.5);
    assert!(rig.base.is_complete(), "{:?}", rig.base.devices().map(|device| device.phase()));
    assert_eq!(rig.last_drive().state, DriveState::Disabled);
    assert!(rig.last_wheels().stamp.seconds_since(Stamp::ZERO) > 1.5);
}

/// The cable breaks: the drive's own watchdog (1016h, 6007h) has to stop the robot.
#[test]
fn a_broken_cable_stops_the_robot_without_us() {
    let mut rig = Rig::new();
    rig.run(1.0);
    rig.drive(0.8, 0.0);
    rig.run(3.0);
    let from_m = rig.simulation.truth().robot.x_m;
    rig.cut = true;
    rig.run(1.0);
    let truth = rig.simulation.truth();
    assert!(truth.twist.linear_mps.abs() < 0.01, "{:?}", truth.twist);
    // 0.2 s of silence, a heartbeat's distance before it, then 2 m/s².
    let path_m = truth.robot.x_m - from_m;
    assert!(path_m < 0.8 * 0.26 + 0.16 + 0.02, "{path_m}");
    for node in 1..=5 {
        assert!(rig.events.contains(&BaseEvent::NodeLost(node)), "{node}");
    }
    assert_eq!(rig.base.counters().losses, 5);
    rig.base.command(DriveCommand::Stop(StopKind::TorqueOff));
    rig.cut = false;
    rig.run(1.5);
    assert!(rig.base.is_complete());
    assert_eq!(rig.last_drive().state, DriveState::Disabled);
    rig.drive(0.5, 0.0);
    rig.run(2.0);
    assert!(rig.simulation.truth().twist.linear_mps > 0.4);
}

/// Too short a break for us to miss a heartbeat, long enough for the drive: it has stopped by itself, and that is a
/// fault until somebody resets it.
#[test]
fn self_stopped_drive_is_fault_until_reset() {
    let mut rig = Rig::new();
    rig.run(1.0);
    rig.drive(0.8, 0.0);
    // In the middle between two heartbeats: two of them are missed.
    rig.run(2.05);
    rig.cut = true;
    rig.run(0.21);
    rig.cut = false;
    rig.run(1.0);
    assert_eq!(rig.base.counters().losses, 0);
    assert!(matches!(rig.last_drive().state, DriveState::Fault(_)), "{:?}", rig.last_drive());
    assert!(rig.simulation.truth().twist.linear_mps.abs() < 0.01, "although the command is still to move");
    let watchdog = |event: &BaseEvent| matches!(event, BaseEvent::Emergency(1, lost) if lost.code == 0x8130);
    assert!(rig.events.iter().any(watchdog));
    rig.base.reset_faults();
    rig.run(2.0);
    assert_eq!(rig.last_drive().state, DriveState::Enabled);
}

/// Our own computer restarts while the robot moves: the new master stops it before it configures anything.
#[test]
fn new_master_stops_a_running_robot_first() {
    let mut rig = Rig::new();
    rig.run(1.0);
    rig.drive(0.8, 0.0);
    rig.run(3.0);
    let from_m = rig.simulation.truth().robot.x_m;
    let configuration = BaseConfiguration { inputs: INPUTS, ..BaseConfiguration::default() };
    rig.base = ThreeWheelBase::new(configuration);
    rig.run(0.7);
    let truth = rig.simulation.truth();
    assert!(truth.twist.linear_mps.abs() < 0.01, "{:?}", truth.twist);
    // The brake's 1.5 m/s² and two polls.
    let path_m = truth.robot.x_m - from_m;
    assert!(path_m < 0.30, "{path_m}");
    rig.run(0.5);
    assert!(rig.base.is_complete());
}

/// Without the gateway no input is judged any more: its last report must not stay in force.
#[test]
fn silent_gateway_is_unknown_not_clear() {
    let mut rig = Rig::new();
    rig.run(1.0);
    rig.muted = Some(5);
    let before = rig.events.len();
    rig.run(1.0);
    let inputs = |event: &&BaseEvent| matches!(event, BaseEvent::Inputs(_));
    assert_eq!(rig.events[before..].iter().find(inputs), None);
    assert!(rig.events.contains(&BaseEvent::NodeLost(5)));
    rig.simulation.safety_channels().bumper_front = [true, false];
    rig.muted = None;
    rig.run(1.5);
    assert!(rig.base.is_complete());
    let last = rig.events.iter().rev().find_map(|event| match event {
        BaseEvent::Inputs(inputs) => Some(*inputs),
        _ => None,
    });
    assert_eq!(
        last.map(|inputs| inputs.bumper_front),
        Some(SafetyInput::Fault),
        "one channel for over 100 ms"
    );
}
