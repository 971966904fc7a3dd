//! The two checks against fields, beside plain ones that look at everything and know no short cuts.

use super::fixtures::{config, packet, rectangle, scan, tables};
use crate::packet_check::PacketFinding;
use crate::protection::Blocked;
use crate::scan_check::{SILENT_PERCENT_MAX, SILENT_RUN_RAD, ScanFinding};
use crate::*;
use floorguard_types::capacities::PACKET_RINGS_MAX;
use floorguard_types::geometry::{Point2, Pose2};
use floorguard_types::random::Pcg32;
use floorguard_types::sensing::{BeamReturn, LidarColumn, LidarPacket, Scan, silent_cdeg};
use floorguard_types::time::Stamp;
use floorguard_types::units::radians;

/// Nothing of it is symmetric; one warning field is smaller than its protective field, and the body hides some beams.
fn crooked() -> (GuardConfig, Body) {
    let mut config = config();
    config.lidar.mounting.translation.y_m = 0.1;
    config.scanner.mounting = Pose2::new(0.9, 0.1, 0.05);
    config.scanner.sector_rad = [radians(-130.0), radians(120.0)];
    config.fields[1].warning = rectangle([-0.45, 1.1], 0.55);
    (config, Body { x_m: [-0.45, 0.95], y_m: [-0.3, 0.45] })
}

/// Distance to a box, by its definition.
fn is_inside(body: &Body, point: Point2) -> bool {
    (body.x_m[0]..=body.x_m[1]).contains(&point.x_m) && (body.y_m[0]..=body.y_m[1]).contains(&point.y_m)
}

fn block(blocked: &mut Blocked, point: Point2, body: &Body) {
    blocked.forward |= is_inside(body, point) || point.x_m > body.x_m[1];
    blocked.backward |= is_inside(body, point) || point.x_m < body.x_m[0];
}

/// Every return of a packet against the limits of its bin, in 64 bits.
fn plain_packet(table: &PacketTable, packet: &LidarPacket, set: usize, body: &Body) -> PacketFinding {
    let mut finding = PacketFinding { nearest_m: f32::INFINITY, ..PacketFinding::default() };
    for column in &packet.columns {
        let bin = table.bins[usize::from(column.azimuth_cdeg) / 200];
        let reach_mm = u64::from(bin.protective_mm[set]);
        for (ring, raw) in column.range_raw.iter().enumerate() {
            let range_mm = u64::from(*raw) * u64::from(packet.range_unit_mm);
            let plane_mm = range_mm * u64::from(bin.plane_share[ring]) / 65_536;
            let outside = plane_mm >= reach_mm || plane_mm < u64::from(bin.own_mm);
            if *raw == 0 || range_mm >= u64::from(bin.height_mm[ring]) || outside {
                continue;
            }
            finding.returns = finding.returns.saturating_add(1);
            let plane_m = plane_mm as f32 * 0.001;
            if plane_m < finding.nearest_m {
                (finding.nearest_m, finding.nearest_limit_m) = (plane_m, reach_mm as f32 * 0.001);
            }
            let (dx_m, dy_m) = (plane_m * bin.direction.x_m, plane_m * bin.direction.y_m);
            let point = Point2::new(table.origin.x_m + dx_m, table.origin.y_m + dy_m);
            block(&mut finding.blocked, point, body);
        }
    }
    finding
}

/// A raw range at, or one step beside, a limit of the table.
fn tricky_raw(bin: &crate::protection::Bin, ring: usize, unit_mm: u32, random: &mut Pcg32) -> u16 {
    let share = f32::from(bin.plane_share[ring]).max(1.0) / 65_536.0;
    let set = random.below(4) as usize;
    let limit_mm = match random.below(5) {
        0 => f32::from(bin.protective_mm[set]) / share,
        1 => f32::from(bin.height_mm[ring]),
        2 => f32::from(bin.own_mm) / share,
        3 => return 0,
        _ => random.below(6_000) as f32,
    };
    let raw = (limit_mm / unit_mm as f32).ceil().min(65_533.0) as u16;
    raw.saturating_add(random.below(3) as u16).saturating_sub(1)
}

#[test]
fn fg_req_023_each_return_equals_the_plain_check() {
    let (config, body) = crooked();
    let (_, table) = tables(&config);
    let mut random = Pcg32::new(11, 1);
    let mut judged = [0_u32; 3];
    for round in 0..4_000_u32 {
        let unit_mm = [1_u8, 2, 4][(round % 3) as usize];
        let mut columns = packet(Stamp::ZERO, 0, 10.0).columns;
        // Some packets hold a single return, so that each of its numbers is seen.
        let single = round % 2 == 0;
        for column in &mut columns {
            *column = LidarColumn { azimuth_cdeg: random.below(36_000) as u16, ..LidarColumn::SILENT };
        }
        let places = if single { 1 } else { columns.len() * 4 };
        for _ in 0..places {
            let length = columns.len() as u32;
            let column = &mut columns[random.below(length) as usize];
            let ring = random.below(PACKET_RINGS_MAX as u32) as usize;
            let bin = &table.bins[usize::from(column.azimuth_cdeg) / 200];
            column.range_raw[ring] = tricky_raw(bin, ring, u32::from(unit_mm), &mut random);
        }
        let packet = LidarPacket { stamp: Stamp::ZERO, range_unit_mm: unit_mm, rings: 16, columns };
        for set in 0..config.fields.len() {
            let (found, plain) =
                (table.check(&packet, set, &body), plain_packet(&table, &packet, set, &body));
            assert_eq!(found, plain, "round {round}, set {set}");
            judged[usize::from(plain.returns.min(2))] += 1;
        }
    }
    assert!(judged.iter().all(|count| *count > 500), "{judged:?}");
}

#[test]
fn fg_req_016_the_silent_span_of_a_packet_wraps_round() {
    let silent = |first: u16, last: u16| {
        let columns = [first, last].map(|azimuth_cdeg| LidarColumn { azimuth_cdeg, ..LidarColumn::SILENT });
        silent_cdeg(&LidarPacket { columns: columns.into_iter().collect(), ..LidarPacket::EMPTY })
    };
    assert_eq!((silent(100, 560), silent(35_900, 360), silent(0, 0)), (480, 480, 20));
    assert_eq!(silent_cdeg(&packet(Stamp::ZERO, 0, 3.0)), 0);
    assert_eq!(silent_cdeg(&LidarPacket::EMPTY), 0);
}

/// Every beam against both limits, run by run.
fn plain_scan(table: &ScanTable, scan: &Scan, set: usize, (adjacent, body): (u8, &Body)) -> ScanFinding {
    let mut finding = ScanFinding { nearest_m: f32::INFINITY, ..ScanFinding::default() };
    let (mut runs, mut silent, mut widest) = ([0_u32; 3], 0_u32, 0_u32);
    for (index, beam) in scan.beams.iter().enumerate() {
        let (limit_mm, warning_mm) = (table.protective[set][index], table.warning[set][index]);
        let hit_mm = match beam {
            BeamReturn::Hit(range_mm) => Some(*range_mm),
            _ => None,
        };
        let free = matches!(beam, BeamReturn::Free(range_mm) if *range_mm >= limit_mm);
        let is = [
            hit_mm.is_some_and(|range_mm| range_mm < limit_mm),
            hit_mm.is_some_and(|range_mm| range_mm < warning_mm),
            hit_mm.is_none() && !free && limit_mm > 0,
        ];
        for (run, is) in runs.iter_mut().zip(is) {
            *run = if is { *run + 1 } else { 0 };
        }
        silent += u32::from(is[2]);
        widest = widest.max(runs[2]);
        finding.protective |= runs[0] >= u32::from(adjacent);
        finding.warning |= runs[1] >= u32::from(adjacent);
        if let Some(range_mm) = hit_mm.filter(|_| is[0]) {
            let range_m = f32::from(range_mm) * 0.001;
            if range_m < finding.nearest_m {
                (finding.nearest_m, finding.nearest_limit_m) = (range_m, f32::from(limit_mm) * 0.001);
            }
            let (mounting, direction) = (table.geometry.mounting, table.directions[index]);
            let x_m = mounting.x_m + range_m * direction.x_m;
            block(&mut finding.blocked, Point2::new(x_m, mounting.y_m + range_m * direction.y_m), body);
        }
    }
    let watched = table.protective[set].iter().filter(|limit| **limit > 0).count();
    finding.silent_percent = 100.0 * silent as f32 / watched as f32;
    finding.silent_run_rad = widest as f32 * table.geometry.step_rad;
    finding
}

#[test]
fn fg_req_020_each_beam_equals_the_plain_check() {
    let (config, body) = crooked();
    let (table, _) = tables(&config);
    let mut random = Pcg32::new(12, 1);
    let mut seen = [0_u32; 5];
    for round in 0..3_000_u32 {
        let mut scan = scan(Stamp::ZERO, 1, &[]);
        for _ in 0..1 + random.below(6) {
            let (from, count) = (random.below(541) as usize, 1 + random.below(8) as usize);
            let set = random.below(4) as usize;
            let kind = random.below(8);
            for index in from..(from + count).min(541) {
                let limit_mm = if kind.is_multiple_of(2) {
                    table.protective[set][index]
                } else {
                    table.warning[set][index]
                };
                let near_mm = limit_mm.saturating_add(random.below(3) as u16).saturating_sub(1);
                scan.beams[index] = match kind {
                    0..=2 => BeamReturn::Hit(near_mm),
                    3 => BeamReturn::Hit(random.below(4_000) as u16),
                    4 | 5 => BeamReturn::Free(near_mm),
                    _ => BeamReturn::Unknown,
                };
            }
        }
        for set in 0..config.fields.len() {
            for adjacent in 1..4 {
                let how = (adjacent, &body);
                let (found, plain) = (table.check(&scan, set, how), plain_scan(&table, &scan, set, how));
                assert_eq!(found, plain, "round {round}, set {set}, {adjacent} adjacent");
                let kinds = [
                    plain.protective,
                    plain.warning && !plain.protective,
                    plain.is_blind(),
                    plain.blocked.forward,
                    plain.blocked.backward,
                ];
                seen.iter_mut().zip(kinds).for_each(|(count, is)| *count += u32::from(is));
            }
        }
    }
    assert!(seen.iter().all(|count| *count > 100), "{seen:?}");
}

#[test]
fn fg_req_024_blindness_begins_above_its_limits() {
    let blind = |silent_percent: f32, silent_run_rad: f32| {
        ScanFinding { silent_percent, silent_run_rad, ..ScanFinding::default() }.is_blind()
    };
    assert!(!blind(SILENT_PERCENT_MAX, SILENT_RUN_RAD));
    assert!(blind(SILENT_PERCENT_MAX.next_up(), 0.0) && blind(0.0, SILENT_RUN_RAD.next_up()));
}

#[test]
fn fg_req_020_a_scan_of_another_geometry_does_not_fit() {
    let config = config();
    let (table, _) = tables(&config);
    let good = scan(Stamp::ZERO, 1, &[]);
    let with = |start_rad: f32, step_rad: f32| Scan {
        first_angle_rad: good.first_angle_rad + start_rad,
        step_rad: good.step_rad + step_rad,
        ..good.clone()
    };
    assert!(table.fits(&good) && table.fits(&with(0.9e-3, 0.9e-5)) && table.fits(&with(-0.9e-3, -0.9e-5)));
    for (start_rad, step_rad) in [(1.1e-3, 0.0), (-1.1e-3, 0.0), (0.0, 1.1e-5), (0.0, -1.1e-5)] {
        assert!(!table.fits(&with(start_rad, step_rad)), "{start_rad} {step_rad}");
    }
    // Exactly at the tolerance: numbers whose difference has no rounding.
    let mut exact = table.clone();
    (exact.geometry.first_angle_rad, exact.geometry.step_rad) = (0.0, 1.0e-5);
    let scan_at = |first_angle_rad: f32, step_rad: f32| Scan { first_angle_rad, step_rad, ..good.clone() };
    assert!(exact.fits(&scan_at(1.0e-3_f32.next_down(), 1.0e-5)) && !exact.fits(&scan_at(1.0e-3, 1.0e-5)));
    assert!(exact.fits(&scan_at(0.0, 2.0e-5_f32.next_down())) && !exact.fits(&scan_at(0.0, 2.0e-5)));
    let mut short = good.clone();
    short.beams.pop();
    assert!(!table.fits(&short));
    let mut rig = super::fixtures::Rig::cruising();
    rig.guard.on_scan(&short, rig.now);
    assert!(rig.guard.causes().any(|record| record.cause == Cause::SourceLost(Source::Scanner)));
}

#[test]
fn fg_req_040_object_level_with_the_body_is_not_approached() {
    let body = Body { x_m: [-0.5, 1.0], y_m: [-0.4, 0.4] };
    let blocks = |x_m: f32, y_m: f32| {
        let mut blocked = Blocked::default();
        blocked.add(Point2::new(x_m, y_m), &body);
        (blocked.forward, blocked.backward)
    };
    assert_eq!(blocks(1.0, 0.6), (false, false));
    assert_eq!(blocks(1.0_f32.next_up(), 0.6), (true, false));
    assert_eq!(blocks(-0.5, 0.6), (false, false));
    assert_eq!(blocks((-0.5_f32).next_down(), 0.6), (false, true));
    assert_eq!((blocks(0.0, 0.6), blocks(0.0, 0.4)), ((false, false), (true, true)));
}
