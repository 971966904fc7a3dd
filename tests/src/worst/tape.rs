//! A scene as a tape: six turns of the lidar and fifteen scans of the safety scanner.

use floorguard_laboratory::world::Plan;
use floorguard_operator::telemetry::Tape;
use floorguard_runtime::tape::TapeLine;
use floorguard_sim::wire::{DataPacket, ReturnMode, TelegramHeader, encode_telegram};

use super::scene::{LIDAR_SECTORS, SCANNER_SECTORS, Scene, Sector};
use crate::campaign::Random;

/// Turns of the lidar: the tracker needs some to have tracks.
const TURNS: u64 = 6;
const TURN_US: u64 = 100_000;
/// Packets of a turn; 24 columns of 0.2° each.
const PACKETS: u64 = 75;
const COLUMNS: u64 = 24;
const BEAMS: usize = 541;
const SCAN_US: u64 = 40_000;
/// Height of the lidar over the floor, metres (robot.toml).
const HEIGHT_M: f32 = 0.8;
const ELEVATIONS_DEG: [f32; 16] =
    [-15.0, 1.0, -13.0, 3.0, -11.0, 5.0, -9.0, 7.0, -7.0, 9.0, -5.0, 11.0, -3.0, 13.0, -1.0, 15.0];

/// The tape. Equal scenes give equal bytes.
///
/// # Errors
/// The built-in scenario, whose route leads the tape, is broken.
pub fn tape_of(scene: &Scene) -> anyhow::Result<Vec<u8>> {
    let plan = Plan::named("empty", 1, TURNS * TURN_US)?;
    let mut tape = Tape::new(&plan.robot, plan.duration_us);
    let mut events: Vec<(u64, TapeLine, Vec<u8>)> = Vec::new();
    let mut noise = crate::campaign::Slice { seed: 1, trials: 0..1 }.random(0);
    for packet in 0..TURNS * PACKETS {
        let at_us = 1_000 + packet * TURN_US / PACKETS;
        events.push((at_us, TapeLine::Lidar, lidar_packet(scene, packet, at_us, &mut noise)));
    }
    for scan in 0..TURNS * TURN_US / SCAN_US {
        events.push((20_000 + scan * SCAN_US, TapeLine::Scanner, telegram(scene, scan as u32, &mut noise)));
    }
    events.sort_by_key(|(at_us, ..)| *at_us);
    for (at_us, line, bytes) in events {
        tape.record((at_us, at_us), line, &bytes);
    }
    Ok(tape.finish())
}

fn lidar_packet(scene: &Scene, number: u64, at_us: u64, noise: &mut Random) -> Vec<u8> {
    let mut packet = DataPacket::new(ReturnMode::Strongest, at_us as u32);
    for column in 0..COLUMNS {
        let of_turn = (number % PACKETS) * COLUMNS + column;
        let block = (column / 2) as usize;
        if column % 2 == 0 {
            packet.set_azimuth(block, (of_turn * 20) as u32);
        }
        let sector =
            scene.lidar[(of_turn as usize * LIDAR_SECTORS / (PACKETS * COLUMNS) as usize) % LIDAR_SECTORS];
        for (laser, elevation_deg) in ELEVATIONS_DEG.iter().enumerate() {
            let range_m = lidar_range_m(sector, of_turn, *elevation_deg, noise);
            let raw = (range_m.clamp(0.0, 130.0) * 500.0) as u16;
            packet.set_cell(block, 16 * (column % 2) as usize + laser, raw, 50);
        }
    }
    packet.into_bytes()
}

/// Metres; 0 is no return.
fn lidar_range_m(sector: Sector, column: u64, elevation_deg: f32, noise: &mut Random) -> f32 {
    let jitter_m = noise.below(41) as f32 * 1.0e-3 - 0.02;
    let range_m = sector.range_m();
    let down = -elevation_deg.to_radians().sin();
    let floor_m = if down > 0.01 { HEIGHT_M / down } else { 20.0 };
    let in_sector = column % 20;
    let range_m = match sector.pattern {
        0 => return 0.0,
        1 => floor_m,
        2 => range_m,
        3 => {
            if in_sector.is_multiple_of(2) {
                range_m
            } else {
                20.0
            }
        }
        4 => range_m + if (in_sector + elevation_deg.abs() as u64).is_multiple_of(2) { 0.0 } else { 0.6 },
        5 => range_m + noise.below(2_000) as f32 * 1.0e-3,
        6 => range_m + (elevation_deg + 15.0) * 0.05,
        7 => {
            if (4..9).contains(&in_sector) {
                range_m
            } else {
                floor_m
            }
        }
        8 => {
            if in_sector % 5 < 2 {
                range_m
            } else {
                range_m + 1.5
            }
        }
        _ => floor_m.min(range_m + noise.below(2_000) as f32 * 1.0e-3),
    };
    range_m.min(floor_m) + jitter_m
}

fn telegram(scene: &Scene, scan: u32, noise: &mut Random) -> Vec<u8> {
    let words: Vec<u16> = (0..BEAMS)
        .map(|beam| {
            let sector = scene.scanner[(beam / 10).min(SCANNER_SECTORS - 1)];
            let range_m = match sector.pattern {
                // Nothing came back.
                0 => return 0x1FFF,
                3 | 4 if beam % 2 == 1 => 25.0,
                5 | 9 => sector.range_m() + noise.below(1_000) as f32 * 1.0e-3,
                7 if !(3..7).contains(&(beam % 10)) => 25.0,
                8 if beam % 5 < 2 => sector.range_m() + 1.5,
                _ => sector.range_m(),
            };
            (range_m * 100.0) as u16
        })
        .collect();
    let header = TelegramHeader { version: 0x0103, status: 0, scan, telegram: scan as u16 };
    encode_telegram(header, &words)
}

#[cfg(test)]
mod tests {
    use super::*;
    use floorguard_runtime::tape::TapeReader;

    #[test]
    fn equal_scenes_give_equal_tapes_with_every_packet() {
        let scene = Scene::random(&mut crate::campaign::Slice { seed: 4, trials: 0..1 }.random(0));
        let bytes = tape_of(&scene).expect("a tape");
        assert_eq!(bytes, tape_of(&scene).expect("a tape"));
        let records: Vec<_> = TapeReader::new(&bytes).expect("readable").collect();
        let of = |line| records.iter().filter(|record| record.line == line).count() as u64;
        assert_eq!((of(TapeLine::Lidar), of(TapeLine::Scanner)), (TURNS * PACKETS, 15));
    }
}
