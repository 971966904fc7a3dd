//! Samples become even beams: the nearest return counts, and what was not measured is unknown.

use std::vec::Vec;

use super::{RPLIDAR_A, RPLIDAR_S, RangingEvent, RangingScanner, Rplidar};
use floorguard_types::sensing::{BeamReturn, Scan};
use floorguard_types::time::Stamp;

/// A node at an angle, degrees clockwise, and a distance, millimetres.
fn node(angle_deg: f32, range_mm: u16) -> [u8; 5] {
    let angle = (((angle_deg * 64.0).round() as u16 % 23_040) << 1) | 1;
    let [low, high] = angle.to_le_bytes();
    let [range_low, range_high] = (range_mm << 2).to_le_bytes();
    [0x3E, low, high, range_low, range_high]
}

const STREAM: [u8; 7] = [0xA5, 0x5A, 5, 0, 0, 0x40, 0x81];

/// Turns of `count` samples in a tenth of a second each, of the distances that `range_mm` gives.
fn scans(scanner: &mut Rplidar, (turns, count): (u64, u64), range_mm: impl Fn(f32) -> u16) -> Vec<Scan> {
    let mut found = Vec::new();
    scanner.push(&STREAM, Stamp::ZERO, &mut |event| panic!("{event:?}"));
    for index in 0..turns * count {
        let angle_deg = (index % count) as f32 * 360.0 / count as f32;
        let now = Stamp::from_micros(1_000_000 + index * 100_000 / count);
        scanner.push(&node(angle_deg, range_mm(angle_deg)), now, &mut |event| match event {
            RangingEvent::Scan(scan) => found.push(scan.clone()),
            other => panic!("{other:?}"),
        });
    }
    found
}

/// Something to the right, something nearer to the left, and behind nothing comes back.
#[test]
fn samples_stand_in_beams_of_the_robot() {
    let range_mm = |angle_deg: f32| match angle_deg {
        80.0..100.0 => 2_000,
        260.0..280.0 => 1_000,
        170.0..190.0 => 0,
        _ => 5_000,
    };
    let scans = scans(&mut Rplidar::new(RPLIDAR_S), (4, 1_000), range_mm);
    assert_eq!(scans.len(), 2, "the first turn was not heard from its beginning");
    let scan = &scans[1];
    assert_eq!((scan.beams.len(), scan.sequence), (720, 2));
    let beam = |angle_deg: f32| {
        let index = (angle_deg.to_radians() - scan.first_angle_rad) / scan.step_rad;
        scan.beams[index.round() as usize % 720]
    };
    assert_eq!([beam(0.0), beam(-90.0), beam(90.0)], [5_000, 2_000, 1_000].map(BeamReturn::Hit));
    assert_eq!([beam(180.0), beam(-172.0), beam(172.0)], [BeamReturn::Unknown; 3]);
    let unknown = scan.beams.iter().filter(|beam| **beam == BeamReturn::Unknown).count();
    assert!((38..=40).contains(&unknown), "{unknown} beams of half a degree for 20°");
    // The middle of the turn, and what a sample waits until it arrives.
    assert_eq!(scan.stamp, Stamp::from_micros(1_000_000 + 250_000 - RPLIDAR_S.delay_us));
}

/// Of two returns in a beam the nearer one counts, whichever comes first.
#[test]
fn nearest_return_of_a_beam_counts() {
    for near_first in [true, false] {
        let range_mm = |angle_deg: f32| {
            let is_near = (angle_deg * 10.0) as u32 % 12 < 6;
            if is_near == near_first { 1_000 } else { 3_000 }
        };
        let scans = scans(&mut Rplidar::new(RPLIDAR_A), (3, 3_600), range_mm);
        assert_eq!(scans.len(), 1);
        assert!(scans[0].beams.iter().all(|beam| *beam == BeamReturn::Hit(1_000)));
    }
}

/// A head that turns too fast for its samples leaves beams unknown: never free.
#[test]
fn beams_without_samples_are_unknown() {
    let scans = scans(&mut Rplidar::new(RPLIDAR_A), (3, 200), |_| 2_000);
    let unknown = scans[0].beams.iter().filter(|beam| **beam == BeamReturn::Unknown).count();
    assert_eq!((unknown, scans[0].beams.len()), (100, 300));
    let far = self::scans(&mut Rplidar::new(RPLIDAR_A), (3, 400), |_| 12_001);
    assert!(far[0].beams.iter().all(|beam| *beam == BeamReturn::Unknown));
}

/// Samples near the front that fall back end no second turn.
#[test]
fn angles_that_fall_back_end_one_turn() {
    let mut scanner = Rplidar::new(RPLIDAR_A);
    scanner.push(&STREAM, Stamp::ZERO, &mut |_| {});
    let mut turns = 0;
    for index in 0..1_600_u64 {
        let wobble = if index % 2 == 0 { 1.5 } else { 0.0 };
        let angle_deg = ((index % 400) as f32 * 0.9 + wobble) % 360.0;
        let now = Stamp::from_micros(1_000_000 + index * 250);
        scanner.push(&node(angle_deg, 2_000), now, &mut |event| {
            turns += u32::from(matches!(event, RangingEvent::Scan(_)));
        });
    }
    assert_eq!(turns, 2);
}
