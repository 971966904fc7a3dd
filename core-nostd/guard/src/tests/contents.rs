//! Sensors whose messages go on, and whose contents do not live, or do not see with all rings.

use super::fixtures::{Rig, forward, scan};
use crate::*;
use floorguard_types::capacities::PACKET_RINGS_MAX;
use floorguard_types::geometry::{Point2, Twist2};
use floorguard_types::sensing::{LidarColumn, LidarPacket};

/// Packets of one revolution of 100 ms.
const PACKETS: u32 = 76;

/// What the two sensors of light show: millimetres of a packet, by its number, and of a scan.
struct Sight {
    lidar: fn(packet: u32, ring: usize, azimuth_cdeg: u16) -> u32,
    scan_m: fn(number: u32) -> f32,
}

/// Noise of a few millimetres, another one each time.
fn noise_mm(number: u32, ring: usize) -> u32 {
    let mixed = (number + 1).wrapping_mul(0x9e37_79b1) ^ (ring as u32).wrapping_mul(0x85eb_ca6b);
    2 * ((mixed ^ (mixed >> 15)) % 101)
}

/// The same revolution again and again.
fn same_turn(packet: u32, ring: usize, _: u16) -> u32 {
    5_000 + noise_mm(packet % PACKETS, ring)
}

/// The three lowest rings, over 80 degrees ahead.
fn is_low_ahead(ring: usize, azimuth_cdeg: u16) -> bool {
    ring < 3 && !(4_000..32_000).contains(&azimuth_cdeg)
}

/// Everything lives.
const ALIVE: Sight = Sight {
    lidar: |packet, ring, _| 5_000 + noise_mm(packet, ring),
    scan_m: |number| 6.0 + noise_mm(number, 0) as f32 * 0.001,
};

fn packet(rig: &Rig, number: u32, sight: &Sight) -> LidarPacket {
    let first_cdeg = number * 36_000 / PACKETS;
    let columns = (0..24_u32).map(|index| {
        let azimuth_cdeg = ((first_cdeg + index * 20) % 36_000) as u16;
        let mut range_raw = [0_u16; PACKET_RINGS_MAX];
        for (ring, raw) in range_raw.iter_mut().enumerate().take(16) {
            *raw = ((sight.lidar)(number, ring, azimuth_cdeg) / 2) as u16;
        }
        LidarColumn { azimuth_cdeg, offset_us: index * 55, range_raw, ..LidarColumn::SILENT }
    });
    LidarPacket { stamp: rig.now, range_unit_mm: 2, rings: 16, columns: columns.collect() }
}

/// Drives for some seconds with this sight; the health of scanner and lidar at the end, and the metres until one of them was
/// not healthy.
fn drive(sight: &Sight, wheels: Twist2, seconds: u32) -> ([Health; 2], f32) {
    let mut rig = Rig::cruising();
    rig.silent = std::vec![Source::Scanner, Source::Lidar, Source::Wheels];
    let (mut packets, mut metres) = (0_u32, 0.0);
    let mut health = [Health::Healthy; 2];
    for step in 0..seconds * 100 {
        if step % 4 == 0 {
            let scan = scan(rig.now, step, &[Point2::new((sight.scan_m)(step / 4), 0.5)]);
            rig.guard.on_scan(&scan, rig.now);
            rig.guard.remember_scan(&scan);
        }
        for _ in 0..PACKETS / 10 {
            packets += 1;
            let packet = packet(&rig, packets, sight);
            rig.guard.on_lidar_packet(&packet, rig.now);
            rig.guard.remember_packet(&packet);
        }
        rig.guard.on_wheels(wheels, rig.now, rig.now);
        rig.step();
        let reports = rig.guard.health();
        health = [Source::Scanner, Source::Lidar].map(|source| reports[source.index()].health);
        if health == [Health::Healthy; 2] {
            metres += wheels.linear_mps.abs() * 0.01;
        }
    }
    (health, metres)
}

#[test]
fn fg_req_035_living_ranges_and_standing_robots_are_healthy() {
    assert_eq!(drive(&ALIVE, forward(0.5), 3).0, [Health::Healthy; 2]);
    assert_eq!(drive(&ALIVE, Twist2 { linear_mps: 0.0, angular_radps: 0.5 }, 3).0, [Health::Healthy; 2]);
    // Nothing moves, and nothing is noisy.
    let still = Sight { lidar: same_turn, scan_m: |_| 6.0 };
    assert_eq!(drive(&still, Twist2::ZERO, 3).0, [Health::Healthy; 2]);
}

#[test]
fn fg_req_035_frozen_ranges_behind_a_living_counter() {
    let scanner = Sight { scan_m: |_| 6.0, ..ALIVE };
    let (health, metres) = drive(&scanner, forward(0.5), 1);
    assert_eq!(health, [Health::Frozen, Health::Healthy]);
    assert!(metres < 0.2, "{metres} m");
    let turn = Sight { lidar: same_turn, ..ALIVE };
    let packet = Sight { lidar: |_, ring, _| 5_000 + noise_mm(1, ring), ..ALIVE };
    for lidar in [turn, packet] {
        let (health, metres) = drive(&lidar, forward(0.5), 2);
        assert_eq!(health, [Health::Healthy, Health::Frozen]);
        assert!(metres < 0.5, "{metres} m");
        let turning = Twist2 { linear_mps: 0.0, angular_radps: -0.4 };
        assert_eq!(drive(&lidar, turning, 2).0, [Health::Healthy, Health::Frozen]);
    }
}

fn low_silent_mm(packet: u32, ring: usize, azimuth_cdeg: u16) -> u32 {
    if is_low_ahead(ring, azimuth_cdeg) { 0 } else { (ALIVE.lidar)(packet, ring, azimuth_cdeg) }
}

#[test]
fn fg_req_036_covered_lower_rings_are_blind() {
    let silent = Sight { lidar: low_silent_mm, ..ALIVE };
    let near = Sight {
        lidar: |packet, ring, cdeg| {
            if is_low_ahead(ring, cdeg) { 120 } else { (ALIVE.lidar)(packet, ring, cdeg) }
        },
        ..ALIVE
    };
    for sight in [silent, near] {
        assert_eq!(drive(&sight, Twist2::ZERO, 1).0, [Health::Healthy, Health::Blind]);
    }
}

#[test]
fn fg_req_036_gaps_and_upper_rings_cover_nothing() {
    let narrow = Sight {
        lidar: |packet, ring, cdeg| {
            if ring < 3 && (3_000..8_000).contains(&cdeg) { 0 } else { (ALIVE.lidar)(packet, ring, cdeg) }
        },
        ..ALIVE
    };
    // Open space above, and dark floor far away.
    let open = Sight {
        lidar: |packet, ring, cdeg| if ring > 5 { 0 } else { (ALIVE.lidar)(packet, ring, cdeg) },
        ..ALIVE
    };
    for sight in [narrow, open] {
        assert_eq!(drive(&sight, Twist2::ZERO, 1).0, [Health::Healthy; 2]);
    }
}

#[test]
fn fg_req_036_an_uncovered_lidar_sees_again() {
    let mut rig = Rig::cruising();
    rig.silent.push(Source::Lidar);
    let mut health = std::vec::Vec::new();
    for number in 0..PACKETS * 6 {
        let covered = number < PACKETS * 3;
        let sight = Sight { lidar: if covered { low_silent_mm } else { ALIVE.lidar }, ..ALIVE };
        let packet = packet(&rig, number, &sight);
        rig.guard.on_lidar_packet(&packet, rig.now);
        rig.guard.remember_packet(&packet);
        health.push(rig.guard.health()[Source::Lidar.index()].health);
        if number % 8 == 0 {
            rig.step();
        }
    }
    let blind = health.iter().filter(|health| **health == Health::Blind).count() as u32;
    assert!(health.last() == Some(&Health::Healthy) && blind > PACKETS, "{blind}");
}
