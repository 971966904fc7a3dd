//! The whole world: order and repeatability of events, and a robot that obeys its bus.

use floorguard_sim::{CanFrame, Payload, Scenario, Simulation, Stream, WireEvent};

fn digest(events: &[WireEvent]) -> u64 {
    // FNV-1a over time and bytes.
    let mut hash = 0xCBF2_9CE4_8422_2325_u64;
    let mut add = |byte: u8| hash = (hash ^ u64::from(byte)).wrapping_mul(0x0100_0000_01B3);
    for event in events {
        event.at_us.to_le_bytes().into_iter().for_each(&mut add);
        match &event.payload {
            Payload::Bytes(bytes) => bytes.iter().copied().for_each(&mut add),
            Payload::Frame(frame) => frame.data.into_iter().for_each(&mut add),
        }
    }
    hash
}

fn play(scenario: &str, seed: u64, until_us: u64) -> Vec<WireEvent> {
    let mut simulation = Simulation::new(&Scenario::named(scenario).unwrap(), seed).unwrap();
    let mut events = Vec::new();
    // In uneven steps: the events must not depend on them.
    let mut at_us = 0;
    while at_us < until_us {
        at_us = (at_us + 1 + 997 * (seed + 3)).min(until_us);
        simulation.advance_to(at_us, &mut |event| events.push(event));
    }
    events
}

#[test]
fn same_seed_gives_same_bytes_and_rates() {
    let events = play("supermarket", 5, 1_000_000);
    assert_eq!(digest(&events), digest(&play("supermarket", 5, 1_000_000)));
    assert_ne!(digest(&events), digest(&play("supermarket", 6, 1_000_000)));
    assert!(events.windows(2).all(|pair| pair[0].at_us <= pair[1].at_us));
    let count = |stream| events.iter().filter(|event| event.stream == stream).count();
    assert!((752..=754).contains(&count(Stream::LidarData)), "{}", count(Stream::LidarData));
    assert!((52..=54).contains(&count(Stream::LidarPosition)));
    assert!((115..=125).contains(&count(Stream::ScannerSerial)), "24 or 25 telegrams of 5 pieces");
    assert!((48..=52).contains(&count(Stream::ImuSerial)), "half a second of waking up");
    assert_eq!(
        count(Stream::Can),
        5 + 19,
        "five boot-up messages, the dirt sensor's, and nothing else unasked"
    );
}

fn send(simulation: &mut Simulation, id: u32, payload: &[u8], now_us: u64) {
    simulation.receive_can(CanFrame::new(id, payload), now_us);
}

fn enable_and_drive(simulation: &mut Simulation, speed_mm_s: i32) {
    let mut now_us = 0;
    for node in [0x601, 0x602] {
        for control in [0x06, 0x07, 0x0F] {
            send(simulation, node, &[0x2B, 0x40, 0x60, 0, control, 0, 0, 0], now_us);
            now_us += 1_000;
            simulation.advance_to(now_us, &mut |_| {});
        }
    }
    let [a, b, c, d] = speed_mm_s.to_le_bytes();
    send(simulation, 0x601, &[0x23, 0xFF, 0x60, 0, a, b, c, d], now_us);
}

#[test]
fn robot_drives_on_command_emergency_stop_brakes() {
    let mut simulation = Simulation::new(&Scenario::named("empty").unwrap(), 1).unwrap();
    enable_and_drive(&mut simulation, 800);
    simulation.advance_to(3_000_000, &mut |_| {});
    let before = simulation.truth();
    assert!((before.twist.linear_mps - 0.8).abs() < 1e-3, "{:?}", before.twist);
    simulation.press_emergency_stop(true);
    simulation.advance_to(5_000_000, &mut |_| {});
    let after = simulation.truth();
    assert_eq!(after.twist.linear_mps, 0.0);
    assert!(after.emergency_stop);
    let path_m = after.robot.x_m - before.robot.x_m;
    let expected_m = 0.8 * 0.05 + 0.8 * 0.8 / 3.0;
    assert!((path_m - expected_m).abs() < 0.01, "{path_m} against {expected_m}");
}

#[test]
fn scanner_sees_wall_at_true_distance() {
    let events = play("empty", 2, 300_000);
    let bytes: Vec<u8> = events
        .iter()
        .filter(|event| event.stream == Stream::ScannerSerial)
        .filter_map(|event| match &event.payload {
            Payload::Bytes(bytes) => Some(bytes.clone()),
            Payload::Frame(_) => None,
        })
        .flatten()
        .collect();
    // Beam 270 looks straight ahead: 16 − 0.05 − 0.9 m.
    let word = u16::from_le_bytes([bytes[24 + 540], bytes[25 + 540]]);
    assert!((i32::from(word) - 1_505).abs() <= 5, "{word}");
}

/// Raw distance of a laser in the block whose azimuth is nearest to a direction (clockwise, hundredths of a degree).
fn raw(events: &[WireEvent], azimuth_cdeg: i32, laser: usize) -> i32 {
    let packets = events.iter().filter(|event| event.stream == Stream::LidarData).take(75);
    let blocks = packets.filter_map(|event| match &event.payload {
        Payload::Bytes(bytes) => Some(bytes[..1_200].chunks(100).map(<[u8]>::to_vec).collect::<Vec<_>>()),
        Payload::Frame(_) => None,
    });
    let azimuth = |block: &Vec<u8>| i32::from(u16::from_le_bytes([block[2], block[3]]));
    let block = blocks.flatten().min_by_key(|block| (azimuth(block) - azimuth_cdeg).abs()).unwrap();
    i32::from(u16::from_le_bytes([block[4 + 3 * laser], block[5 + 3 * laser]]))
}

#[test]
fn lidar_sees_floor_and_walls_correctly() {
    let events = play("empty", 3, 150_000);
    let near = |found: i32, expected_m: f32| (found - (expected_m * 500.0) as i32).abs() <= 25;
    let up = libm::cosf(1.0_f32.to_radians());
    assert!(near(raw(&events, 0, 1), 15.45 / up), "ahead: {}", raw(&events, 0, 1));
    assert!(near(raw(&events, 9_000, 1), 9.95 / up), "right: {}", raw(&events, 9_000, 1));
    assert!(near(raw(&events, 27_000, 1), 12.95 / up), "left: {}", raw(&events, 27_000, 1));
    let floor_m = 0.8 / libm::sinf(15.0_f32.to_radians());
    assert!(near(raw(&events, 0, 0), floor_m), "floor: {}", raw(&events, 0, 0));
}
