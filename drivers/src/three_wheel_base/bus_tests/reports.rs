//! What devices report and what they are sent: units, edges, objects.

use super::*;

#[test]
fn drives_report_metres_and_radians() {
    let mut bus = Bus::running();
    let events = bus.drives(0x0237, -1_234, 57_296);
    let [BaseEvent::Drive(feedback)] = events[..] else { panic!("{events:?}") };
    assert_eq!(feedback.state, DriveState::Enabled);
    assert!((feedback.wheel_speed_mps + 1.234).abs() < 1.0e-6, "{feedback:?}");
    assert!((feedback.steering_rad - 1.0).abs() < 1.0e-4, "{feedback:?}");
    assert_eq!(bus.hear(0x181, &[0x37, 2, 0, 0, 0, 0]), [], "one alone is no report");
}

/// The angle goes out in thousandths of a degree, the speed in mm/s; what is no number moves nothing.
#[test]
fn commands_use_the_units_of_the_drives() {
    let mut bus = Bus::running();
    bus.drives(0x0237, 0, 4_000);
    let targets = |bus: &Bus| {
        let mut sent = Vec::new();
        bus.base.send_command(&mut |frame| sent.push(*frame));
        let target = |frame: &CanFrame| i32::from_le_bytes(frame.payload()[2..6].try_into().unwrap());
        sent.iter().map(target).collect::<Vec<_>>()
    };
    bus.base.command(DriveCommand::Move { wheel_mps: 0.5, steering_rad: -0.5 });
    assert_eq!(targets(&bus), [500, -28_648]);
    bus.base.command(DriveCommand::Move { wheel_mps: f32::NAN, steering_rad: f32::INFINITY });
    assert_eq!(targets(&bus), [0, 4_000], "the wheel stands, the angle is held");
    bus.base.command(DriveCommand::Stop(StopKind::Hold));
    assert_eq!(targets(&bus), [0, 4_000]);
}

/// A ramp stops the wheel; the steering keeps its angle until the robot stands.
#[test]
fn a_ramp_leaves_the_steering_its_torque() {
    let mut bus = Bus::running();
    bus.base.command(DriveCommand::Move { wheel_mps: 0.5, steering_rad: 0.1 });
    bus.drives(0x0237, 500, 0);
    bus.base.command(DriveCommand::Stop(StopKind::Ramp));
    assert_eq!(bus.words(), [(0x201, 0x0002), (0x202, 0x000F)]);
    bus.base.command(DriveCommand::Stop(StopKind::TorqueOff));
    assert_eq!(bus.words(), [(0x201, 0x0000), (0x202, 0x0000)]);
}

/// The steering that dropped out by itself is not switched on again by a ramp.
#[test]
fn a_steering_that_left_operation_stays_down() {
    let mut bus = Bus::running();
    bus.base.command(DriveCommand::Move { wheel_mps: 0.5, steering_rad: 0.1 });
    bus.drives(0x0237, 500, 0);
    bus.hear(0x182, &[0x50, 2, 0, 0, 0, 0]);
    bus.hear(0x182, &[0x37, 2, 0, 0, 0, 0]);
    bus.base.command(DriveCommand::Stop(StopKind::Ramp));
    assert_eq!(bus.words()[1], (0x202, 0x0000));
}

/// Three polls without the bit, three with it: an edge that every drive sees. Then the normal words again.
#[test]
fn a_reset_is_an_edge_of_some_polls() {
    let mut bus = Bus::running();
    bus.drives(0x0218, 0, 0);
    bus.base.reset_faults();
    let words: Vec<u16> = (0..8)
        .map(|_| {
            let word = bus.words()[0].1;
            bus.poll();
            word
        })
        .collect();
    assert_eq!(words, [0, 0, 0, 0x80, 0x80, 0x80, 0, 0]);
    bus.drives(0x0240, 0, 0);
    bus.base.reset_faults();
    assert_eq!(bus.words()[0].1 & 0x80, 0, "a drive without a fault needs none");
}

#[test]
fn emergencies_name_device_and_fault_code() {
    let mut bus = Bus::running();
    let emergency = Emergency { code: 0x5441, register: 0x20, manufacturer: [1, 2, 3, 4, 5] };
    let payload = [0x41, 0x54, 0x20, 1, 2, 3, 4, 5];
    assert_eq!(bus.hear(0x080, &payload), [], "SYNC is no emergency");
    for node in [1_u16, 2, 3] {
        assert_eq!(bus.hear(0x080 + node, &payload), [BaseEvent::Emergency(node as u8, emergency)]);
    }
    let fault = |bus: &mut Bus, traction: u16, steering: u16| {
        bus.hear(0x181, &[traction as u8, 2, 0, 0, 0, 0]);
        let events = bus.hear(0x182, &[steering as u8, 2, 0, 0, 0, 0]);
        let [BaseEvent::Drive(feedback)] = events[..] else { panic!("{events:?}") };
        feedback.state
    };
    assert_eq!(fault(&mut bus, 0x18, 0x40), DriveState::Fault(0x5441));
    assert_eq!(fault(&mut bus, 0x40, 0x18), DriveState::Fault(0x5441));
    let mut steered = Bus::running();
    steered.hear(0x082, &payload);
    assert_eq!(fault(&mut steered, 0x40, 0x18), DriveState::Fault(0x5441));
    let mut other = Bus::running();
    other.hear(0x083, &payload);
    assert_eq!(fault(&mut other, 0x40, 0x18), DriveState::Fault(0x1000));
    assert_eq!(
        fault(&mut other, 0x18, 0x40),
        DriveState::Fault(0x1000),
        "an encoder's complaint is not the drive's"
    );
}

#[test]
fn configured_dirt_sensor_is_received() {
    let dirt = BaseConfiguration { dirt_sensor_node: Some(6), ..BaseConfiguration::default() };
    let mut bus = Bus::with(dirt);
    for (flags, brush_turns) in [(1, true), (3, true), (0, false), (2, false)] {
        let stamp = bus.now();
        let reading = DirtReading { stamp, count: 0x0201, brush_turns, sequence: 9 };
        assert_eq!(bus.hear(0x186, &[1, 2, flags, 9, 7]), [BaseEvent::Dirt(reading)]);
    }
    let refused = bus.base.counters().refused;
    assert_eq!(bus.hear(0x186, &[1, 2, 1]), []);
    assert_eq!(bus.base.counters().refused, refused + 1);
    assert_eq!(Bus::running().hear(0x186, &[1, 2, 1, 9]), [], "nobody is configured there");
}

/// The gateway's four objects, and nobody else's.
#[test]
fn inputs_arrive_in_any_gateway_object() {
    let mut configuration = BaseConfiguration::default();
    configuration.inputs.emergency_stop.bits = [0, 1];
    configuration.inputs.bumper_front.bits = [64, 65];
    for (id, object) in [(0x285, 64), (0x385, 128), (0x485, 192)] {
        configuration.inputs.bumper_front.bits = [object, object + 1];
        let mut bus = Bus::with(configuration);
        assert_eq!(bus.hear(0x185, &[3]), [], "not complete yet");
        assert_eq!(bus.hear(id - 1, &[3]), [], "another device");
        assert!(matches!(bus.hear(id, &[3])[..], [BaseEvent::Inputs(_)]), "{id:03X}");
    }
}
