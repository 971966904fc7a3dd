//! Start, odometry and stops of a bus on which everything works.

use super::*;

#[test]
fn bus_is_up_within_a_second() {
    let mut rig = Rig::new();
    rig.run(1.0);
    assert!(rig.base.is_complete(), "{:?}", rig.base.devices().map(|device| device.phase()));
    assert_eq!(rig.last_drive().state, DriveState::Disabled, "no torque before anybody commands");
    assert_eq!(rig.last_emergency_stop(), SafetyInput::Clear);
    rig.drive(0.5, 0.0);
    rig.run(4.0);
    assert_eq!(rig.last_drive().state, DriveState::Enabled);
    let driven_m = rig.simulation.truth().robot.x_m;
    let ticks = rig.last_wheels();
    let measured_m = (ticks.left_ticks + ticks.right_ticks) as f32 / 2.0 / 20_000.0;
    assert!(driven_m > 1.5, "{driven_m}");
    assert!((measured_m - driven_m).abs() < 0.01 * driven_m, "{measured_m} {driven_m}");
    assert!((rig.last_drive().wheel_speed_mps - 0.5).abs() < 0.02);
    assert_eq!(rig.base.counters().refused, 0);
}

#[test]
fn steering_left_turns_left_by_wheel_odometry() {
    let mut rig = Rig::new();
    rig.through_text = Some(TextLine::default());
    rig.run(1.0);
    rig.drive(0.4, 0.6);
    rig.run(3.0);
    let truth = rig.simulation.truth();
    let wheels = rig.last_wheels();
    assert!(truth.robot.heading_rad > 0.3, "{truth:?}");
    assert!(wheels.right_ticks > wheels.left_ticks);
    let turned_rad = (wheels.right_ticks - wheels.left_ticks) as f32 / 20_000.0 / 0.6;
    assert!((turned_rad - truth.robot.heading_rad).abs() < 0.02, "{turned_rad} {}", truth.robot.heading_rad);
    assert!((rig.last_drive().steering_rad - 0.6).abs() < 0.01);
    let line = rig.through_text.unwrap();
    assert!(line.host.counters().frames > 1_000);
    assert_eq!(line.host.counters().refused, 0);
}

#[test]
fn each_stop_stands_within_its_distance() {
    for (kind, state) in [
        (StopKind::Hold, DriveState::Enabled),
        (StopKind::Ramp, DriveState::Disabled),
        (StopKind::TorqueOff, DriveState::Disabled),
    ] {
        let mut rig = Rig::new();
        rig.run(1.0);
        rig.drive(0.8, 0.0);
        rig.run(3.0);
        let from_m = rig.simulation.truth().robot.x_m;
        rig.base.command(DriveCommand::Stop(kind));
        let mut sent = Vec::new();
        rig.base.send_command(&mut |frame| sent.push(*frame));
        rig.deliver(&sent);
        rig.run(2.0);
        let truth = rig.simulation.truth();
        let path_m = truth.robot.x_m - from_m;
        assert!(truth.twist.linear_mps.abs() < 0.01, "{kind:?} {:?}", truth.twist);
        // The guard counts on 0.8 m/s² after 0.15 s: 0.52 m.
        assert!(path_m < 0.52, "{kind:?} {path_m}");
        assert_eq!(rig.last_drive().state, state, "{kind:?}");
    }
}

#[test]
fn emergency_stop_fault_needs_a_reset() {
    let mut rig = Rig::new();
    rig.run(1.0);
    rig.drive(0.5, 0.0);
    rig.run(2.0);
    rig.simulation.press_emergency_stop(true);
    rig.run(1.0);
    assert_eq!(rig.last_emergency_stop(), SafetyInput::Active);
    assert_eq!(rig.last_drive().state, DriveState::Fault(0x5441));
    rig.simulation.press_emergency_stop(false);
    rig.run(1.0);
    assert_eq!(rig.last_drive().state, DriveState::Fault(0x5441), "the command to move alone resets nothing");
    assert!(rig.simulation.truth().twist.linear_mps.abs() < 0.01);
    rig.base.command(DriveCommand::Stop(StopKind::TorqueOff));
    rig.base.reset_faults();
    rig.run(0.5);
    assert_eq!(rig.last_drive().state, DriveState::Disabled);
    rig.drive(0.5, 0.0);
    rig.run(2.0);
    assert!(rig.simulation.truth().twist.linear_mps > 0.4);
}

/// From the command to the drive's target: the frame leaves within the call, or with the very next poll.
#[test]
fn stop_is_first_frame_of_next_poll() {
    let mut rig = Rig::new();
    rig.run(1.0);
    rig.drive(0.5, 0.0);
    rig.run(2.0);
    for (kind, word) in [(StopKind::Hold, 0x0F), (StopKind::Ramp, 0x02), (StopKind::TorqueOff, 0x00)] {
        rig.base.command(DriveCommand::Stop(kind));
        let mut sent = Vec::new();
        rig.base.poll(Stamp::from_micros(rig.now_us), &mut |_| {}, &mut |frame| sent.push(*frame));
        assert_eq!(sent.first(), Some(&CanFrame::standard(0x201, &[word, 0, 0, 0, 0, 0])));
    }
}
