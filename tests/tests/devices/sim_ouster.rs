//! The driver of Ouster lidars against the simulator's, whose bytes were written from the description of the format alone. Ranges are
//! judged by plane geometry of a room.

use crate::sim_support::{bytes_of, mean_and_deviation, room, wall_range_m};
use floorguard_drivers::ouster::{Beams, DataFormat, Decoder};
use floorguard_laboratory::plan::Plan;
use floorguard_laboratory::world::{Observer, load_scenario, run_virtual};
use floorguard_sim::faults::{FaultLayer, FaultSpec};
use floorguard_sim::robot::{LidarDevice, OusterDevice, OusterFormat, RobotParameters};
use floorguard_sim::{Simulation, Stream};
use floorguard_types::geometry::{Point2, Pose2};
use floorguard_types::time::Stamp;

const START: Pose2 = Pose2 { x_m: 0.7, y_m: -0.4, heading_rad: 0.5 };
/// The lidar's place on the robot, metres forward and up.
const MOUNT: (f32, f32) = (0.50, 0.80);
/// From the axis to where its beams leave, metres.
const ORIGIN_M: f64 = 0.015_806;
const COLUMN_US: f64 = 100_000.0 / 1_024.0;

/// Sixteen beams that look to either side of their columns.
const ALTITUDE_MDEG: [i32; 16] = {
    let mut altitudes = [0; 16];
    let mut channel = 0;
    while channel < 16 {
        altitudes[channel] = 15_000 - 2_000 * channel as i32;
        channel += 1;
    }
    altitudes
};
const AZIMUTH_MDEG: [i32; 16] = [
    4_230, 1_410, -1_410, -4_230, 4_230, 1_410, -1_410, -4_230, 4_230, 1_410, -1_410, -4_230, 4_230, 1_410,
    -1_410, -4_230,
];

fn device(format: OusterFormat) -> OusterDevice {
    OusterDevice {
        format,
        columns_per_turn: 1_024,
        columns_per_packet: 16,
        altitude_mdeg: &ALTITUDE_MDEG,
        azimuth_mdeg: &AZIMUTH_MDEG,
        beam_origin_um: 15_806,
    }
}

fn beams(format: DataFormat) -> Beams {
    let mut beams = Beams { format, beam_origin_um: 15_806, ..Beams::even(16, (15_000, -15_000)) };
    beams.azimuth_mdeg[..16].copy_from_slice(&AZIMUTH_MDEG);
    beams
}

/// Datagrams of a standing robot behind a network.
fn datagrams((format, seed): (OusterFormat, u64), until_us: u64, fault: Option<&str>) -> Vec<(u64, Vec<u8>)> {
    let parameters =
        RobotParameters { lidar_device: LidarDevice::Ouster(device(format)), ..RobotParameters::default() };
    let mut simulation = Simulation::with_robot(&room(START), seed, parameters).unwrap();
    let specs: Vec<FaultSpec> = fault.iter().map(|text| FaultSpec::parse(text).unwrap()).collect();
    let mut layer = FaultLayer::new(&specs, seed);
    let mut arrived = Vec::new();
    simulation.advance_to(until_us, &mut |event| {
        layer.pass(event, &mut |event| {
            if let Some(bytes) = bytes_of(&event, Stream::LidarData) {
                arrived.push((event.at_us, bytes.to_vec()));
            }
        });
    });
    arrived
}

#[test]
fn ouster_returns_meet_wall_or_floor() {
    let formats = [
        (OusterFormat::Legacy, DataFormat::Legacy, 0.004),
        (OusterFormat::Single, DataFormat::Single, 0.004),
        (OusterFormat::Dual, DataFormat::Dual, 0.004),
        (OusterFormat::LowRate, DataFormat::LowRate, 0.008),
    ];
    let sensor = START.compose(Pose2::new(MOUNT.0, 0.0, 0.0));
    for (sent, read, step_m) in formats {
        let beams = beams(read);
        let mut decoder = Decoder::new(&beams);
        let (mut errors, mut cells) = (Vec::new(), 0);
        for (number, (at_us, bytes)) in datagrams((sent, 1), 300_000, None).into_iter().enumerate() {
            let (packet, lost) = decoder.decode(&bytes, Stamp::from_micros(at_us)).unwrap();
            assert_eq!((packet.rings, packet.range_unit_mm, lost), (16, 4, 0));
            assert!(number == 0 || packet.columns.len() == 16);
            for column in packet.columns.iter().filter(|_| number > 1) {
                for (ring, raw) in column.range_raw.iter().take(16).enumerate() {
                    cells += 1;
                    if *raw == 0 {
                        continue;
                    }
                    let elevation = (-15.0 + 2.0 * ring as f64).to_radians();
                    // What a beam's azimuth has beside whole columns, and where the head looked: there the beam leaves.
                    let turned_deg = f64::from(beams.shift(15 - ring)) * 360.0 / 1_024.0;
                    let head_deg = f64::from(column.azimuth_cdeg) * 0.01 - turned_deg;
                    let beam_deg = head_deg + f64::from(AZIMUTH_MDEG[15 - ring]) * 1.0e-3;
                    let bearing = |turned_deg: f64| f64::from(sensor.heading_rad) - turned_deg.to_radians();
                    let (sin, cos) = bearing(head_deg).sin_cos();
                    let leaves = Point2::new(
                        sensor.x_m + (ORIGIN_M * cos) as f32,
                        sensor.y_m + (ORIGIN_M * sin) as f32,
                    );
                    let wall_m = wall_range_m(leaves, bearing(beam_deg)) / elevation.cos() + ORIGIN_M;
                    let floor_m = f64::from(MOUNT.1) / (-elevation.sin()).max(1.0e-9) + ORIGIN_M;
                    errors.push(f64::from(*raw) * 0.004 - wall_m.min(floor_m));
                }
            }
        }
        let (mean, deviation) = mean_and_deviation(&errors);
        let worst = errors.iter().fold(0.0_f64, |worst, error| worst.max(error.abs()));
        println!("{sent:?}: mean {mean} m, deviation {deviation} m, worst {worst} m");
        // Noise of 8 mm ends at 27.7 mm; ranges are cut to the step, and columns to whole ones.
        assert!(
            (mean + step_m / 2.0).abs() < 0.004 && worst <= 0.060,
            "{sent:?}: mean {mean} m, worst {worst} m"
        );
        assert!((0.9..1.3).contains(&(deviation / 0.008)), "{sent:?}: deviation {deviation} m");
        let kept = errors.len() as f64 / f64::from(cells);
        assert!((0.998..0.9997).contains(&kept), "{sent:?}: one in a thousand drops out: {kept}");
    }
}

/// The simulator's head turns evenly; column 0 looks back at time 0.
#[test]
fn ouster_stamps_are_those_of_the_columns() {
    let mut decoder = Decoder::new(&beams(DataFormat::Single));
    for (number, (at_us, bytes)) in
        datagrams((OusterFormat::Single, 3), 3_000_000, None).into_iter().enumerate()
    {
        let (packet, _) = decoder.decode(&bytes, Stamp::from_micros(at_us)).unwrap();
        for column in packet.columns.iter().filter(|_| number > 1) {
            let stamp_us = (packet.stamp.as_micros() + u64::from(column.offset_us)) as f64;
            let turned_cdeg = (stamp_us * 0.36 + 18_000.0).rem_euclid(36_000.0);
            let error_cdeg =
                (f64::from(column.azimuth_cdeg) - turned_cdeg + 18_000.0).rem_euclid(36_000.0) - 18_000.0;
            // Stamps are at most as late as the network was at least.
            let late_us = -error_cdeg / 0.36;
            assert!((-COLUMN_US / 16.0..250.0).contains(&late_us), "packet {number}: {late_us} us");
        }
    }
    assert_eq!(decoder.clock_restarts(), 0);
}

#[test]
fn dropped_ouster_packets_are_counted() {
    let mut decoder = Decoder::new(&beams(DataFormat::Single));
    let arrived = datagrams((OusterFormat::Single, 4), 2_000_000, Some("lidar:drop=5%"));
    for (at_us, bytes) in &arrived {
        decoder.decode(bytes, Stamp::from_micros(*at_us)).unwrap();
    }
    let missing = 20 * 64 - arrived.len() as u64;
    let counted = u64::from(decoder.counters().lost);
    assert!(missing > 30 && missing.abs_diff(counted) <= 3, "{missing} missing, {counted} counted");
}

/// A board at 0.7 m, which the lidar alone sees: the robot stands before it, and without its lidar it does not drive at all.
#[test]
fn robot_with_an_ouster_stops_before_boards() {
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/../hal-sim/scenarios/hazards/board-70.toml");
    let keys = floorguard_configuration::ouster_keys(&floorguard_configuration::ouster_example());
    let drive = |fault: Option<&str>| {
        let scenario = load_scenario(path.as_ref()).unwrap();
        let plan = Plan::of("board-70", scenario, 1, 10_000_000).unwrap();
        let mut plan = plan.with_lidar(&keys).unwrap();
        plan.lidar_grain = 2;
        plan.faults.extend(fault.map(|text| FaultSpec::parse(text).unwrap()));
        let mut show = |_: f64, _: &_, _: usize, _: &[_]| {};
        let mut observer = Observer::new(&plan, &mut show);
        run_virtual(&plan, &mut observer).unwrap();
        let verdict = observer.into_observation().verdict;
        (verdict.distance_m, verdict.bodies.counts.while_moving())
    };
    let (distance_m, contacts) = drive(None);
    assert!(distance_m > 2.0 && contacts == 0, "{distance_m} m, {contacts} contacts");
    let (distance_m, _) = drive(Some("lidar:drop=100%"));
    assert!(distance_m < 0.05, "{distance_m} m without the lidar");
}
