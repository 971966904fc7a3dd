//! The driver of the PandarXT-16 against the simulator's, whose bytes were written from the description of the format alone. Ranges
//! are judged by plane geometry of a room.

use crate::sim_support::{bytes_of, mean_and_deviation, room, wall_range_m};
use floorguard_drivers::hesai::Decoder;
use floorguard_laboratory::plan::Plan;
use floorguard_laboratory::world::{Observer, load_scenario, run_virtual};
use floorguard_sim::faults::{FaultLayer, FaultSpec};
use floorguard_sim::robot::{LidarDevice, RobotParameters};
use floorguard_sim::{Simulation, Stream};
use floorguard_types::geometry::{Point2, Pose2};
use floorguard_types::time::Stamp;

const START: Pose2 = Pose2 { x_m: 0.7, y_m: -0.4, heading_rad: 0.5 };
/// The lidar's place on the robot, metres forward and up.
const MOUNT: (f32, f32) = (0.50, 0.80);

/// Datagrams of a standing robot behind a network.
fn datagrams(seed: u64, until_us: u64, fault: Option<&str>) -> Vec<(u64, Vec<u8>)> {
    let parameters = RobotParameters { lidar_device: LidarDevice::PandarXt16, ..RobotParameters::default() };
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
fn pandar_returns_meet_wall_or_floor() {
    let sensor = START.compose(Pose2::new(MOUNT.0, 0.0, 0.0));
    let mut decoder = Decoder::new();
    let (mut errors, mut cells) = (Vec::new(), 0);
    for (at_us, bytes) in datagrams(1, 300_000, None) {
        let (packet, lost) = decoder.decode(&bytes, Stamp::from_micros(at_us)).unwrap();
        assert_eq!((packet.columns.len(), packet.rings, packet.range_unit_mm, lost), (8, 16, 4, 0));
        for column in &packet.columns {
            for (ring, raw) in column.range_raw.iter().take(16).enumerate() {
                cells += 1;
                if *raw == 0 {
                    continue;
                }
                // The lasers fire from the uppermost down while the head turns.
                let fired_us = 0.368 + 3.024 * (15 - ring) as f64;
                let azimuth_cdeg = f64::from(column.azimuth_cdeg) + 0.36 * fired_us;
                let bearing = f64::from(sensor.heading_rad) - (azimuth_cdeg * 0.01).to_radians();
                let elevation = (-15.0 + 2.0 * ring as f64).to_radians();
                let wall_m = wall_range_m(Point2::new(sensor.x_m, sensor.y_m), bearing) / elevation.cos();
                let floor_m = f64::from(MOUNT.1) / (-elevation.sin()).max(1.0e-9);
                errors.push(f64::from(*raw) * 0.004 - wall_m.min(floor_m));
            }
        }
    }
    let (mean, deviation) = mean_and_deviation(&errors);
    let worst = errors.iter().fold(0.0_f64, |worst, error| worst.max(error.abs()));
    // Noise of 8 mm ends at 27.7 mm, a count is 4 mm, and azimuths are cut to hundredths of a degree.
    assert!(mean.abs() < 0.001 && worst <= 0.036, "mean {mean} m, worst {worst} m");
    assert!((0.9..1.15).contains(&(deviation / 0.008)), "deviation {deviation} m");
    let kept = errors.len() as f64 / f64::from(cells);
    assert!((0.9985..0.9995).contains(&kept), "one in a thousand drops out: {kept}");
}

/// The simulator's head turns evenly from azimuth 0 at time 0.
#[test]
fn pandar_stamps_are_those_of_the_firings() {
    let mut decoder = Decoder::new();
    for (number, (at_us, bytes)) in (0_u64..).zip(datagrams(3, 5_000_000, None)) {
        let (packet, _) = decoder.decode(&bytes, Stamp::from_micros(at_us)).unwrap();
        let late_us = packet.stamp.as_micros() as f64 - (number * 400) as f64;
        assert!((-2.0..200.0).contains(&late_us), "packet {number}: {late_us} us");
        for (firing, column) in (0_u64..).zip(&packet.columns) {
            assert_eq!(u64::from(column.offset_us), 50 * firing);
            let turned = (f64::from(column.azimuth_cdeg) - (number * 400 + 50 * firing) as f64 * 0.36)
                .rem_euclid(36_000.0);
            assert!(turned.min(36_000.0 - turned) <= 1.0, "packet {number}: {turned} cdeg");
        }
    }
    assert_eq!(decoder.clock_restarts(), 0);
}

#[test]
fn dropped_pandar_packets_are_counted() {
    let mut decoder = Decoder::new();
    let arrived = datagrams(4, 2_000_000, Some("lidar:drop=5%"));
    for (at_us, bytes) in &arrived {
        decoder.decode(bytes, Stamp::from_micros(*at_us)).unwrap();
    }
    let sent = 2_000_000 / 400;
    let missing = sent - arrived.len() as u64;
    let counted = u64::from(decoder.counters().lost);
    assert!(missing > 150 && missing.abs_diff(counted) <= 3, "{missing} missing, {counted} counted");
}

/// A board at 0.7 m, which the lidar alone sees: the robot stands before it, and without its lidar it does not drive at all.
#[test]
fn robot_with_a_pandar_stops_before_boards() {
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/../hal-sim/scenarios/hazards/board-70.toml");
    let drive = |fault: Option<&str>| {
        let scenario = load_scenario(path.as_ref()).unwrap();
        let plan = Plan::of("board-70", scenario, 1, 10_000_000).unwrap();
        let mut plan = plan.with_lidar("model = \"pandar-xt16\"").unwrap();
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
