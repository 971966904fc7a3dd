//! Devices that fall silent, come back, run already or do not obey.

use super::*;

/// A device that falls silent is reported once and counted; its drive is stopped, its last report does not
/// count.
#[test]
fn lost_drive_is_reported_and_forgotten() {
    for node in [1_u8, 2] {
        let mut bus = Bus::running();
        bus.base.command(DriveCommand::Move { wheel_mps: 0.5, steering_rad: 0.0 });
        bus.drives(0x0237, 0, 0);
        assert_eq!(bus.words()[0].1, 0x000F);
        bus.silent.push(node);
        let mut reported = Vec::new();
        for _ in 0..60 {
            let (sent, events) = bus.poll();
            // The remaining devices are notified of a loss at once, not with the next poll.
            let commands = sent.iter().filter(|frame| frame.standard_id() == Some(0x201)).count();
            assert_eq!(commands, 1 + events.len(), "{events:?}");
            reported.extend(events);
        }
        assert_eq!(reported, [BaseEvent::NodeLost(node)]);
        assert_eq!((bus.base.counters().losses, bus.base.is_complete()), (1, false));
        // It comes back and is started again, but nothing is known of it: the wheel gets no target and no way to operate.
        bus.silent.clear();
        (0..200).for_each(|_| _ = bus.poll());
        assert!(bus.base.is_complete());
        bus.base.command(DriveCommand::Move { wheel_mps: 0.5, steering_rad: 0.0 });
        let wanted: &[(u16, u16)] =
            if node == 1 { &[(0x201, 0x0002), (0x202, 0x000F)] } else { &[(0x201, 0x000F)] };
        assert_eq!(bus.words(), wanted);
        let mut sent = Vec::new();
        bus.base.send_command(&mut |frame| sent.push(*frame));
        assert_eq!(sent[0].payload()[2..], [0; 4]);
    }
}

/// An encoder that was away may have turned any way: its count goes on from where it was, without a jump.
#[test]
fn an_encoder_that_returns_makes_no_jump() {
    for (lost, wanted) in [(3_u8, (0, 50)), (4, (50, 0)), (5, (50, 50))] {
        let mut bus = Bus::running();
        let sample = |bus: &mut Bus, left: u8, right: u8| {
            bus.hear(0x183, &[left, 0, 0, 0, 0, 0]);
            let events = bus.hear(0x184, &[right, 0, 0, 0, 0, 0]);
            let [BaseEvent::Wheels(sample)] = events[..] else { panic!("{events:?}") };
            (sample.left_ticks, sample.right_ticks)
        };
        let before = sample(&mut bus, 10, 10);
        bus.silent.push(lost);
        (0..60).for_each(|_| _ = bus.poll());
        bus.silent.clear();
        (0..200).for_each(|_| _ = bus.poll());
        assert!(bus.base.is_complete());
        let after = sample(&mut bus, 60, 60);
        let moved = (after.0 - before.0, after.1 - before.1);
        assert_eq!(moved, wanted, "node {lost}");
    }
}

/// What one SYNC latched is not mixed with what the next one did.
#[test]
fn positions_of_two_moments_make_no_sample() {
    let mut bus = Bus::running();
    assert_eq!(bus.hear(0x183, &[10, 0, 0, 0, 0, 0]), []);
    bus.poll();
    assert_eq!(bus.hear(0x184, &[10, 0, 0, 0, 0, 0]), []);
    bus.now_ms += 9;
    assert!(matches!(bus.hear(0x183, &[10, 0, 0, 0, 0, 0])[..], [BaseEvent::Wheels(_)]), "9 ms are in time");
    bus.poll();
    bus.now_ms += 10;
    bus.hear(0x183, &[10, 0, 0, 0, 0, 0]);
    assert_eq!(bus.base.counters().late, 1);
}

/// The master sends every 50 ms, or the devices that monitor it stop the robot.
#[test]
fn the_master_keeps_its_heartbeat() {
    let mut bus = Bus::running();
    let beats: Vec<bool> = (0..20).map(|_| bus.poll().0.contains(&CanFrame::standard(0x77F, &[5]))).collect();
    assert_eq!(beats.iter().filter(|beat| **beat).count(), 4);
    assert!(beats.windows(5).all(|five| five.iter().filter(|beat| **beat).count() == 1), "{beats:?}");
}

/// The traction drive was in operation before this master started; that is reported once, and for no other
/// device.
#[test]
fn running_drive_is_reported() {
    for node in 1..=5_u16 {
        let mut bus = Bus {
            base: ThreeWheelBase::new(BaseConfiguration::default()),
            now_ms: 1_000,
            silent: Vec::new(),
        };
        let events = bus.hear(0x700 + node, &[5]);
        let wanted: &[BaseEvent] = if node == 1 { &[BaseEvent::FoundRunning] } else { &[] };
        assert_eq!(events, wanted, "node {node}");
        assert_eq!(bus.hear(0x700 + node, &[0x7F]), []);
    }
}

/// A drive that lost its master and fell to pre-operational, as CiA 301 has it without object 1029h, or that was stopped: its
/// heartbeat was set up by somebody, and it has not booted since.
#[test]
fn fg_req_018_drive_leaving_operation_meanwhile_is_reported() {
    for (state, node) in [0x7F, 0x04].into_iter().flat_map(|state| (1..=5_u16).map(move |node| (state, node)))
    {
        let mut bus = Bus {
            base: ThreeWheelBase::new(BaseConfiguration::default()),
            now_ms: 1_000,
            silent: Vec::new(),
        };
        let wanted: &[BaseEvent] = if node == 1 { &[BaseEvent::FoundRunning] } else { &[] };
        assert_eq!(bus.hear(0x700 + node, &[state]), wanted, "node {node}");
        assert_eq!(bus.hear(0x700 + node, &[state]), [], "once");
    }
}

/// The master asks before it changes anything: the answer tells whether somebody has set up a heartbeat before.
#[test]
fn fg_req_018_early_drive_answer_is_reported() {
    for (period_ms, found) in [(0_u8, false), (100, true)] {
        let mut base = ThreeWheelBase::new(BaseConfiguration::default());
        let (mut sent, mut events) = (Vec::new(), Vec::new());
        let now = Stamp::from_micros(1_000_000);
        base.poll(now, &mut |_| (), &mut |frame| sent.push(*frame));
        let call = CanFrame::standard(0x601, &[0x40, 0x17, 0x10, 0, 0, 0, 0, 0]);
        assert!(sent.contains(&call), "{sent:?}");
        let answer = CanFrame::standard(0x581, &[0x4B, 0x17, 0x10, 0, period_ms, 0, 0, 0]);
        base.on_frame(&answer, now, &mut |event| events.push(event));
        assert_eq!(!events.is_empty(), found, "{period_ms} ms: {events:?}");
    }
}

/// A drive that boots while the master listens is fresh, whatever it says afterwards.
#[test]
fn fg_req_018_a_drive_that_boots_is_not_found() {
    let mut bus =
        Bus { base: ThreeWheelBase::new(BaseConfiguration::default()), now_ms: 1_000, silent: Vec::new() };
    assert_eq!((bus.hear(0x701, &[0]), bus.hear(0x701, &[0x7F])), (Vec::new(), Vec::new()));
}

/// Object 1029h: a drive keeps its network state when the master falls silent.
#[test]
fn fg_req_018_drives_are_configured_to_stay_operational() {
    let mut bus =
        Bus { base: ThreeWheelBase::new(BaseConfiguration::default()), now_ms: 1_000, silent: Vec::new() };
    let mut asked = Vec::new();
    for _ in 0..80 {
        let (sent, _) = bus.poll();
        for frame in sent.iter().filter(|frame| frame.payload().get(1..3) == Some([0x29, 0x10].as_slice())) {
            asked.push(*frame);
        }
    }
    let stay = |node: u16| CanFrame::standard(0x600 + node, &[0x2F, 0x29, 0x10, 1, 1, 0, 0, 0]);
    assert_eq!(asked, [stay(2), stay(1)], "the steering has the shorter script");
}

/// FG-REQ-055: a wheel that goes on turning although it is commanded to stand is stopped by silence and by
/// NMT.
#[test]
fn disobedient_traction_drive_is_left_alone() {
    let mut bus = Bus::running();
    bus.base.command(DriveCommand::Move { wheel_mps: 1.0, steering_rad: 0.0 });
    bus.drives(0x0237, 1_000, 0);
    (0..30).for_each(|_| _ = bus.poll());
    bus.base.command(DriveCommand::Stop(StopKind::Ramp));
    let stop = CanFrame::standard(0, &[2, 1]);
    let beat = CanFrame::standard(0x77F, &[5]);
    // The steering is away meanwhile: it is called all the same.
    bus.silent.push(2);
    let (mut silenced, mut called) = (0, 0);
    for _ in 0..250 {
        bus.drives(0x0237, 1_000, 0);
        let (sent, _) = bus.poll();
        if sent.contains(&stop) {
            silenced += 1;
            called += u32::from(sent.iter().any(|frame| frame.standard_id() == Some(0x602)));
            assert!(!sent.contains(&beat), "no heartbeat while it disobeys");
            assert!(!sent.contains(&CanFrame::standard(0, &[1, 1])), "nor a start");
        }
    }
    assert!(silenced > 150 && called > 0, "{silenced} {called}");
    assert_eq!(bus.base.counters().silences, silenced);
}

/// What is no number orders a halt, and a halt is given its time: a wheel that begins to slow down after 140 ms obeys.
#[test]
fn non_finite_order_stops_the_drives() {
    for wheel_mps in [f32::NAN, f32::INFINITY, f32::NEG_INFINITY] {
        let mut bus = Bus::running();
        bus.base.command(DriveCommand::Move { wheel_mps: 0.8, steering_rad: 0.0 });
        bus.drives(0x0237, 800, 0);
        (0..30).for_each(|_| _ = bus.poll());
        bus.base.command(DriveCommand::Move { wheel_mps, steering_rad: 0.0 });
        for step in 0..100 {
            bus.drives(0x0237, (800 - 15 * (step - 14).max(0)).max(0), 0);
            bus.poll();
        }
        assert_eq!(bus.base.counters().silences, 0, "{wheel_mps}");
        // It rolls again, although nothing but that was ordered.
        for _ in 0..30 {
            bus.drives(0x0237, 800, 0);
            bus.poll();
        }
        assert!(bus.base.counters().silences > 0, "{wheel_mps}");
    }
}

/// The drives watch the master: 127 and 200 ms in one word; ramps in mm/s².
#[test]
fn drives_get_heartbeat_and_braking_configuration() {
    let configuration =
        BaseConfiguration { acceleration_mps2: 0.5, quick_stop_mps2: 2.5, ..BaseConfiguration::default() };
    let mut base = ThreeWheelBase::new(configuration);
    let mut written = Vec::new();
    let mut now_ms = 0;
    for _ in 0..200 {
        let mut sent = Vec::new();
        now_ms += 10;
        let now = Stamp::from_micros(now_ms * 1_000);
        base.poll(now, &mut |_| (), &mut |frame| sent.push(*frame));
        for frame in sent {
            if let (id @ (0x601 | 0x602), &[command, low, high, sub, a, b, c, d]) =
                (frame.standard_id().unwrap(), frame.payload())
            {
                written.push((id, u16::from_le_bytes([low, high]), sub, u32::from_le_bytes([a, b, c, d])));
                let done = if command == 0x40 { 0x43 } else { 0x60 };
                base.on_frame(
                    &CanFrame::standard(id - 0x80, &[done, low, high, sub, 0, 0, 0, 1]),
                    now,
                    &mut |_| (),
                );
            }
        }
    }
    for wanted in [
        (0x601, 0x1016, 1, 0x007F_00C8),
        (0x602, 0x1016, 1, 0x007F_00C8),
        (0x601, 0x1017, 0, 100),
        (0x601, 0x6007, 0, 3),
        (0x601, 0x6083, 0, 500),
        (0x601, 0x6084, 0, 1_500),
        (0x601, 0x6085, 0, 2_500),
    ] {
        assert!(written.contains(&wanted), "{wanted:X?} is not in {written:X?}");
    }
}
