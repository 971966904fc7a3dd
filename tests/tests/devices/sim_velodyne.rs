//! The lidar's driver against the simulator's lidar, whose bytes were written from the description of the format alone.
//! Ranges are judged by plane geometry of a room, not by anybody's ray caster.

use std::collections::BTreeMap;

use crate::sim_support::{DrivenSimulation, HALF_M, bytes_of, mean_and_deviation, room, wall_range_m};
use floorguard_drivers::velodyne::{
    DecodeError, Decoder, Gprmc, Model, ModelChoice, Packet, PositionPacket, PpsState, Return, Returns,
    ReturnsOf, SweepBuilder,
};
use floorguard_sim::Stream;
use floorguard_sim::faults::{FaultLayer, FaultSpec};
use floorguard_sim::robot::{RobotBody, RobotParameters};
use floorguard_sim::sensors::{Lidar, View};
use floorguard_sim::wire::ReturnMode;
use floorguard_types::geometry::{Point2, Pose2, wrap_angle};
use floorguard_types::sensing::{LidarPacket, Sweep};
use floorguard_types::time::Stamp;

const START: Pose2 = Pose2 { x_m: 0.7, y_m: -0.4, heading_rad: 0.5 };
/// The lidar's place on the robot, metres forward and up.
const MOUNT: (f32, f32) = (0.50, 0.80);
/// The simulator's noise: four uniform numbers, so it ends at two times the square root of three deviations.
const NOISE_M: f64 = 0.008;
const NOISE_END_M: f64 = 0.027_72;
/// A count is 2 mm; azimuths are whole hundredths of a degree, cut by the sensor and rounded by the driver: two of them
/// at 6 m under the flattest angle of this room are 5 mm.
const GRID_M: f64 = 0.006;
/// From packet to packet, ns.
const PACKET_NS: u64 = 1_327_104;
/// 600 rpm: hundredths of a degree a microsecond.
const CDEG_PER_US: f64 = 0.36;

type Datagram = (u64, Vec<u8>);

/// Datagrams of a standing robot, as sent and as they arrive over a bad network.
fn datagrams(seed: u64, seconds: f64, faults: &[&str]) -> (Vec<Datagram>, Vec<Datagram>) {
    let specs: Vec<FaultSpec> = faults.iter().map(|text| FaultSpec::parse(text).unwrap()).collect();
    let mut layer = FaultLayer::new(&specs, seed);
    let (mut sent, mut arrived) = (Vec::new(), Vec::new());
    let mut simulation = floorguard_sim::Simulation::new(&room(START), seed).unwrap();
    let take = |event: &floorguard_sim::WireEvent, list: &mut Vec<Datagram>| {
        if let Some(bytes) = bytes_of(event, Stream::LidarData) {
            list.push((event.at_us, bytes.to_vec()));
        }
    };
    simulation.advance_to((seconds * 1.0e6) as u64, &mut |event| {
        take(&event, &mut sent);
        layer.pass(event, &mut |event| take(&event, &mut arrived));
    });
    (sent, arrived)
}

fn decoder() -> Decoder {
    Decoder::new(ModelChoice::Auto)
}

fn returns_of(bytes: &[u8], of: ReturnsOf) -> Vec<Return> {
    let packet = Packet::new_checked(bytes).unwrap();
    let mut found = Vec::new();
    Returns::new(Model::Vlp16).for_each(&packet, of, |echo| found.push(echo));
    found
}

/// Elevation of a laser, degrees (book, Velodyne: Laser angles), written down again.
fn elevation_deg(laser: u8) -> f64 {
    let ring = if laser.is_multiple_of(2) { laser / 2 } else { 8 + (laser - 1) / 2 };
    -15.0 + 2.0 * f64::from(ring)
}

/// What a beam of a lidar at `sensor` must measure: the nearer of wall and floor, and the surface's reflectivity.
fn expected(sensor: Pose2, azimuth_cdeg: f64, elevation_deg: f64) -> (f64, u8) {
    let bearing = f64::from(sensor.heading_rad) - (azimuth_cdeg * 0.01).to_radians();
    let elevation = elevation_deg.to_radians();
    let wall_m = wall_range_m(Point2::new(sensor.x_m, sensor.y_m), bearing) / elevation.cos();
    let floor_m = if elevation < 0.0 { f64::from(MOUNT.1) / -elevation.sin() } else { f64::INFINITY };
    if floor_m < wall_m { (floor_m, 30) } else { (wall_m, 45) }
}

fn judge(name: &str, errors: &[f64]) {
    let worst = errors.iter().fold(0.0_f64, |worst, error| worst.max(error.abs()));
    let (mean, deviation) = mean_and_deviation(errors);
    assert!(worst <= NOISE_END_M + GRID_M, "{name}: worst {worst} m");
    assert!(mean.abs() < 0.001, "{name}: mean {mean} m");
    assert!((0.9..1.15).contains(&(deviation / NOISE_M)), "{name}: deviation {deviation} m");
}

#[test]
fn standing_robot_returns_meet_wall_or_floor() {
    let sensor = START.compose(Pose2::new(MOUNT.0, 0.0, 0.0));
    let (sent, _) = datagrams(1, 0.5, &[]);
    let (mut errors, mut cells) = (Vec::new(), 0);
    for (_, bytes) in &sent {
        cells += 384;
        for echo in returns_of(bytes, ReturnsOf::DistinctEchoes) {
            let (range_m, reflectivity) =
                expected(sensor, f64::from(echo.azimuth_cdeg), elevation_deg(echo.laser));
            errors.push(f64::from(echo.distance_raw) * 0.002 - range_m);
            // Where wall and floor meet, a hair of azimuth decides.
            if (0.02..f64::INFINITY).contains(&floor_and_wall_differ_m(sensor, &echo)) {
                assert_eq!(echo.reflectivity, reflectivity, "{echo:?}");
            }
        }
    }
    judge("standing", &errors);
    let kept = errors.len() as f64 / f64::from(cells);
    assert!((0.9985..0.9995).contains(&kept), "one in a thousand drops out: {kept}");
}

fn floor_and_wall_differ_m(sensor: Pose2, echo: &Return) -> f64 {
    let elevation = elevation_deg(echo.laser).to_radians();
    let bearing = f64::from(sensor.heading_rad) - (f64::from(echo.azimuth_cdeg) * 0.01).to_radians();
    let wall_m = wall_range_m(Point2::new(sensor.x_m, sensor.y_m), bearing);
    (wall_m * elevation.tan() + f64::from(MOUNT.1)).abs()
}

/// The range image says the same as the single returns: rings by elevation, azimuth in the middle of the sequence.
#[test]
fn columns_are_the_same_returns_by_elevation() {
    let (sent, _) = datagrams(2, 0.3, &[]);
    let mut decoder = decoder();
    for (at_us, bytes) in &sent {
        let (packet, lost) = decoder.decode(bytes, Stamp::from_micros(*at_us)).unwrap();
        assert_eq!((packet.columns.len(), packet.rings, packet.range_unit_mm, lost), (24, 16, 2, 0));
        let mut cells = BTreeMap::new();
        for echo in returns_of(bytes, ReturnsOf::AllCells) {
            let column = usize::from(echo.block) * 2 + usize::from(echo.offset_ns % 110_592 >= 55_296);
            let ring = ((elevation_deg(echo.laser) + 15.0) / 2.0) as usize;
            cells.insert((column, ring), (echo.distance_raw, echo.reflectivity));
        }
        for (index, column) in packet.columns.iter().enumerate() {
            for ring in 0..16 {
                let cell = (column.range_raw[ring], column.reflectivity[ring]);
                assert_eq!(cell, cells.get(&(index, ring)).copied().unwrap_or((0, 0)));
            }
        }
    }
}

/// The simulator's head turns evenly from azimuth 0 at time 0, so azimuth and stamp have one truth each.
#[test]
fn stamps_and_azimuths_are_those_of_the_firings() {
    let (sent, _) = datagrams(3, 20.0, &[]);
    let mut decoder = decoder();
    for (number, (at_us, bytes)) in (0_u64..).zip(&sent) {
        let (packet, _) = decoder.decode(bytes, Stamp::from_micros(*at_us)).unwrap();
        let first_ns = number * PACKET_NS;
        // 120 µs on the network, and the creep that a crystal is allowed.
        let late_us = packet.stamp.as_micros() as f64 - first_ns as f64 * 1.0e-3;
        assert!((-1.0..200.0).contains(&late_us), "packet {number}: {late_us} us");
        for (sequence, column) in (0_u64..).zip(&packet.columns) {
            let offset_ns = sequence * 55_296;
            assert!(u64::from(column.offset_us).abs_diff(offset_ns / 1_000) <= 1);
            let measured = packet.stamp.as_micros() + u64::from(column.offset_us);
            assert!(measured <= *at_us, "a firing after the arrival of its packet");
            let middle_us = (first_ns + offset_ns) as f64 * 1.0e-3 + 17.28;
            let turned = (f64::from(column.azimuth_cdeg) - middle_us * CDEG_PER_US).rem_euclid(36_000.0);
            let error_cdeg = turned.min(36_000.0 - turned);
            assert!(error_cdeg <= 2.0, "packet {number}: {error_cdeg} cdeg");
        }
    }
    assert_eq!(decoder.clock_restarts(), 0);
}

/// The robot drives a circle: with the driver's stamps and the true poses every return lies on its wall. A stamp that
/// is a packet too late would show as more than twice the allowed mean.
#[test]
fn driving_robot_returns_lie_on_walls() {
    let mut seat = DrivenSimulation::new(&room(Pose2::new(-1.5, 0.5, 0.2)), 4);
    let mut truths = BTreeMap::new();
    let mut datagrams = Vec::new();
    for ms in 0..9_000_u64 {
        if ms == 1_000 {
            seat.drive(0.8, 0.75);
        }
        for event in seat.step() {
            if let Some(bytes) = bytes_of(&event, Stream::LidarData) {
                datagrams.push((event.at_us, bytes.to_vec()));
            }
        }
        let truth = seat.simulation.truth();
        truths.insert(seat.now_us(), (truth.robot, truth.twist));
    }
    let pose_at = |at_us: f64| {
        let (base_us, (pose, twist)) = truths.range(..=at_us as u64).next_back().unwrap();
        let ahead_s = ((at_us - *base_us as f64) * 1.0e-6) as f32;
        pose.compose(Pose2::new(twist.linear_mps * ahead_s, 0.0, twist.angular_radps * ahead_s))
    };
    let mut decoder = decoder();
    let (mut errors, mut sideways) = (Vec::new(), Vec::new());
    let mut fastest = 0.0_f32;
    for (at_us, bytes) in &datagrams {
        let (packet, _) = decoder.decode(bytes, Stamp::from_micros(*at_us)).unwrap();
        if *at_us < 3_000_000 {
            continue;
        }
        for echo in returns_of(bytes, ReturnsOf::DistinctEchoes) {
            let at_us = packet.stamp.as_micros() as f64 + f64::from(echo.offset_ns) * 1.0e-3;
            let sensor = pose_at(at_us).compose(Pose2::new(MOUNT.0, 0.0, 0.0));
            let elevation = elevation_deg(echo.laser);
            let (range_m, _) = expected(sensor, f64::from(echo.azimuth_cdeg), elevation);
            let error_m = f64::from(echo.distance_raw) * 0.002 - range_m;
            errors.push(error_m);
            // How much the range grows when the robot turns: a late stamp shows here with one sign.
            let (turned_m, _) = expected(sensor, f64::from(echo.azimuth_cdeg) - 10.0, elevation);
            let slope_m_per_rad = (turned_m - range_m) / 0.1_f64.to_radians();
            if slope_m_per_rad.abs() > 1.0 && slope_m_per_rad.abs() < 10.0 {
                sideways.push((slope_m_per_rad, error_m));
            }
        }
        fastest = fastest.max(pose_turn(&truths, *at_us).abs());
    }
    assert!(fastest > 0.5, "it turns: {fastest} rad/s");
    judge("driving", &errors);
    // Least squares of error over slope: the angle by which the stamps are wrong.
    let angle_rad = sideways.iter().map(|(slope, error)| slope * error).sum::<f64>()
        / sideways.iter().map(|(slope, _)| slope * slope).sum::<f64>();
    let late_us = angle_rad / f64::from(fastest) * 1.0e6;
    assert!(late_us.abs() < 700.0, "stamps are late by {late_us} us");
}

fn pose_turn(truths: &BTreeMap<u64, (Pose2, floorguard_types::geometry::Twist2)>, at_us: u64) -> f32 {
    truths.range(..=at_us).next_back().map_or(0.0, |(_, (_, twist))| twist.angular_radps)
}

/// Of a finished sweep: columns, unknown ones, packets, lost packets.
type Revolution = (usize, usize, u16, u16);

/// Sends datagrams to decoder and builder; gives the accepted packets with the loss before each, and finished sweeps.
fn revolutions(arrived: &[Datagram], decoder: &mut Decoder) -> (Vec<(LidarPacket, u16)>, Vec<Revolution>) {
    let (mut packets, mut sweeps) = (Vec::new(), Vec::new());
    let mut builder = SweepBuilder::new(18_000);
    let mut building = Box::new(Sweep::<16>::EMPTY);
    for (at_us, bytes) in arrived {
        let Ok((packet, lost)) = decoder.decode(bytes, Stamp::from_micros(*at_us)) else { continue };
        builder.add(&packet, lost, &mut building, |sweep| {
            let unknown = sweep.used_columns().iter().filter(|column| !column.measured).count();
            sweeps.push((sweep.column_count, unknown, sweep.packets, sweep.lost_packets));
        });
        packets.push((packet, lost));
    }
    (packets, sweeps)
}

#[test]
fn lost_packets_leave_unknown_counted_sectors() {
    for fault in ["lidar:drop=5%", "lidar:burst=30", "lidar:drop=50%"] {
        let (sent, arrived) = datagrams(5, 4.0, &[fault]);
        let mut decoder = decoder();
        let (packets, sweeps) = revolutions(&arrived, &mut decoder);
        assert_eq!(packets.len(), arrived.len());
        let place = |at_us: u64| sent.iter().position(|(sent_us, _)| *sent_us == at_us).unwrap();
        let (first, last) = (place(arrived[0].0), place(arrived[arrived.len() - 1].0));
        let lost = last - first + 1 - arrived.len();
        assert!(lost > 100, "{fault}: {lost}");
        assert_eq!(decoder.counters().lost as usize, lost, "{fault}");
        assert_eq!(packets.iter().map(|(_, lost)| usize::from(*lost)).sum::<usize>(), lost, "{fault}");
        for pair in arrived.windows(2).zip(packets.windows(2)) {
            let ((before, after), (_, (_, reported))) = ((&pair.0[0], &pair.0[1]), (&pair.1[0], &pair.1[1]));
            assert_eq!(usize::from(*reported), place(after.0) - place(before.0) - 1, "{fault}");
        }
        assert!((36..=40).contains(&sweeps.len()), "{fault}: {}", sweeps.len());
        for (columns, unknown, packets, _) in sweeps.iter().skip(1) {
            assert!((1_800..=1_812).contains(columns), "{fault}: {columns} columns");
            let measured = usize::from(*packets) * 24;
            assert!(
                (columns - unknown).abs_diff(measured) <= 24,
                "{fault}: {unknown} unknown, {packets} packets"
            );
        }
        // A gap over the cut is counted in one sweep and lies in two, so that only the sum can be compared.
        let unknown: usize = sweeps.iter().map(|(_, unknown, ..)| unknown).sum();
        let lost_in_sweeps: usize = sweeps.iter().map(|(.., lost)| usize::from(*lost)).sum();
        assert!(
            unknown.abs_diff(lost_in_sweeps * 24) <= lost_in_sweeps * 24 / 50 + 720,
            "{fault}: {unknown}"
        );
    }
}

#[test]
fn repeated_and_overtaken_packets_change_nothing() {
    let (sent, arrived) = datagrams(6, 2.0, &["lidar:duplicate=10%"]);
    let mut decoder = decoder();
    let (packets, _) = revolutions(&arrived, &mut decoder);
    assert_eq!(packets.len(), sent.len());
    assert_eq!(decoder.counters().not_newer as usize, arrived.len() - sent.len());
    assert_eq!(decoder.counters().lost, 0);

    let (sent, arrived) = datagrams(6, 2.0, &["lidar:reorder=5%"]);
    let mut decoder = Decoder::new(ModelChoice::Fixed(Model::Vlp16));
    let (packets, sweeps) = revolutions(&arrived, &mut decoder);
    let refused = decoder.counters().not_newer as usize;
    assert!(refused > 40, "{refused}");
    assert!((0..=1).contains(&(sent.len() - packets.len() - refused)), "the last may still be held");
    assert_eq!(decoder.counters().lost as usize, refused, "what was overtaken is missing in its place");
    assert!(sweeps.iter().skip(1).all(|(columns, ..)| (1_800..=1_812).contains(columns)));
    assert!(packets.windows(2).all(|pair| pair[0].0.stamp < pair[1].0.stamp));
}

#[test]
fn only_broken_datagrams_are_refused() {
    let (_, arrived) = datagrams(7, 2.0, &["lidar:truncate=10%"]);
    let mut decoder = decoder();
    let broken = arrived.iter().filter(|(_, bytes)| bytes.len() != 1_206).count();
    let (packets, _) = revolutions(&arrived, &mut decoder);
    assert!(broken > 100);
    assert_eq!((packets.len(), decoder.counters().refused as usize), (arrived.len() - broken, broken));
    assert!(matches!(decoder.decode(&[0; 603], Stamp::ZERO), Err(DecodeError::Packet(_))));
}

#[test]
fn a_blinded_sector_is_unknown_and_nothing_else() {
    let (_, arrived) = datagrams(8, 0.5, &["lidar:blind=60"]);
    let (packets, _) = revolutions(&arrived, &mut decoder());
    for column in packets.iter().flat_map(|(packet, _)| &packet.columns) {
        let azimuth = column.azimuth_cdeg.min(36_000 - column.azimuth_cdeg);
        let seen = column.range_raw.iter().take(16).filter(|raw| **raw != 0).count();
        match azimuth {
            ..2_960 => assert_eq!(seen, 0, "{azimuth}"),
            3_050.. => assert!(seen >= 13, "{azimuth}"),
            _ => {}
        }
    }
}

/// Pairs of blocks with the same azimuth: half as many columns, each echo once, the same room.
#[test]
fn dual_return_gives_the_same_room() {
    let scenario = room(START);
    let scene = scenario.scene.build();
    let parameters = RobotParameters::default();
    let body = RobotBody::new(parameters.clone(), START);
    let mut lidar = Lidar::new(9, ReturnMode::Dual);
    let sensor = START.compose(Pose2::new(MOUNT.0, 0.0, 0.0));
    let (mut decoder, mut errors, mut last) = (decoder(), Vec::new(), None);
    for _ in 0..300 {
        let at_us = lidar.due_us();
        let bytes = lidar.measure(&View::new(&scene, &[], (&body, parameters.lidar), 60.0), at_us);
        let (packet, lost) = decoder.decode(&bytes, Stamp::from_micros(at_us + 120)).unwrap();
        assert_eq!((packet.columns.len(), lost), (12, 0));
        let distinct = returns_of(&bytes, ReturnsOf::DistinctEchoes);
        assert_eq!(2 * distinct.len(), returns_of(&bytes, ReturnsOf::AllCells).len());
        for echo in &distinct {
            let (range_m, _) = expected(sensor, f64::from(echo.azimuth_cdeg), elevation_deg(echo.laser));
            errors.push(f64::from(echo.distance_raw) * 0.002 - range_m);
        }
        if let Some(last_us) = last.replace(packet.stamp.as_micros()) {
            assert!((663..=665).contains(&(packet.stamp.as_micros() - last_us)), "a packet lasts 664 µs");
        }
    }
    judge("dual", &errors);
}

#[test]
fn position_packets_share_the_clock_without_satellites() {
    let mut simulation = floorguard_sim::Simulation::new(&room(START), 10).unwrap();
    let (mut data_us, mut count) = (None, 0);
    simulation.advance_to(2_000_000, &mut |event| {
        if let Some(bytes) = bytes_of(&event, Stream::LidarData) {
            data_us = Packet::new_checked(bytes).ok().map(|packet| packet.stamp_us());
        }
        let Some(bytes) = bytes_of(&event, Stream::LidarPosition) else { return };
        count += 1;
        let packet = PositionPacket::new_checked(bytes).unwrap();
        assert_eq!(packet.pps(), PpsState::Absent);
        assert!(!packet.is_thermally_shut_down());
        let sentence = Gprmc::parse(packet.sentence()).unwrap();
        assert!(!sentence.is_valid);
        // The newest data packet began at most two packets before.
        let ahead_us = packet.stamp_us() - data_us.unwrap();
        assert!((1_200..=2_800).contains(&ahead_us), "{ahead_us}");
    });
    assert!((106..=108).contains(&count), "{count}");
}

/// The oracle itself: a beam along each axis, and one into a corner.
#[test]
fn the_room_is_as_large_as_its_paper() {
    let middle = Point2::new(0.0, 0.0);
    for (bearing_deg, range_m) in
        [(0.0, HALF_M[0]), (90.0, HALF_M[1]), (180.0, HALF_M[0]), (-90.0, HALF_M[1])]
    {
        let bearing = f64::from(wrap_angle((bearing_deg as f32).to_radians()));
        assert!((wall_range_m(middle, bearing) - f64::from(range_m)).abs() < 1e-6);
    }
    let corner = f64::from(HALF_M[1]).atan2(f64::from(HALF_M[0]));
    assert!((wall_range_m(middle, corner) - f64::from(HALF_M[0].hypot(HALF_M[1]))).abs() < 1e-5);
}
