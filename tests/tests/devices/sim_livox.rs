//! The driver of the Livox Mid-360 against the simulator's, whose bytes were written from the description of the format alone. What comes
//! out is judged by plane geometry of a room.

use crate::sim_support::{bytes_of, mean_and_deviation, room, wall_range_m};
use floorguard_configuration::livox_keys;
use floorguard_drivers::livox::{DEFAULT_ELEVATIONS_MDEG, DecodeError, Decoder};
use floorguard_laboratory::plan::Plan;
use floorguard_laboratory::world::{Observer, load_scenario, run_virtual};
use floorguard_sim::faults::{FaultLayer, FaultSpec};
use floorguard_sim::robot::{LidarDevice, RobotParameters};
use floorguard_sim::{Scenario, Simulation, Stream};
use floorguard_types::geometry::{Point2, Pose2};
use floorguard_types::time::Stamp;

const START: Pose2 = Pose2 { x_m: 0.7, y_m: -0.4, heading_rad: 0.5 };
/// The sensor's place on the robot, metres forward and up.
const MOUNT: (f32, f32) = (0.50, 0.80);

/// Datagrams of a standing robot behind a network.
fn datagrams(hangs: bool, until_us: u64, fault: Option<&str>) -> Vec<(u64, Vec<u8>)> {
    let parameters =
        RobotParameters { lidar_device: LidarDevice::LivoxMid360 { hangs }, ..RobotParameters::default() };
    let mut simulation = Simulation::with_robot(&room(START), 1, parameters).unwrap();
    let specs: Vec<FaultSpec> = fault.iter().map(|text| FaultSpec::parse(text).unwrap()).collect();
    let mut layer = FaultLayer::new(&specs, 1);
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

/// Upright and on its head: where a cell's azimuth and ring look to there is the wall, or the floor between its edges.
#[test]
fn livox_cells_meet_wall_or_floor() {
    let sensor = START.compose(Pose2::new(MOUNT.0, 0.0, 0.0));
    for hangs in [false, true] {
        let side = if hangs { -1.0 } else { 1.0 };
        let mut decoder = Decoder::new(&DEFAULT_ELEVATIONS_MDEG);
        let (mut errors, mut cells, mut floor) = (Vec::new(), 0, 0);
        for (at_us, bytes) in datagrams(hangs, 400_000, None) {
            let (packet, lost) = match decoder.decode(&bytes, Stamp::from_micros(at_us)) {
                Ok(decoded) => decoded,
                Err(DecodeError::Gathering) if at_us < 102_000 => continue,
                Err(error) => panic!("{error}"),
            };
            assert_eq!((packet.rings, packet.range_unit_mm, lost), (16, 4, 0));
            for column in &packet.columns {
                let bearing = f64::from(sensor.heading_rad)
                    - side * (f64::from(column.azimuth_cdeg) * 0.01).to_radians();
                let wall_m = [-0.45_f64, 0.0, 0.45]
                    .map(|off| wall_range_m(Point2::new(sensor.x_m, sensor.y_m), bearing + off.to_radians()));
                let nearest = wall_m.into_iter().fold(f64::INFINITY, f64::min);
                let farthest = wall_m.into_iter().fold(0.0, f64::max);
                for (raw, mdeg) in column.range_raw.iter().zip(&DEFAULT_ELEVATIONS_MDEG) {
                    cells += 1;
                    if *raw == 0 {
                        continue;
                    }
                    let elevation_deg = f64::from(*mdeg) * 1.0e-3;
                    let plane_m = f64::from(*raw) * 0.004 * elevation_deg.to_radians().cos();
                    // Where the lowest and the highest point of the ring meet the floor.
                    let meets_m = |off: f64| {
                        let down = -(side * elevation_deg + off).to_radians().tan();
                        if down > 0.0 { f64::from(MOUNT.1) / down } else { f64::INFINITY }
                    };
                    if plane_m < nearest - 0.04 {
                        floor += 1;
                        let (near_m, far_m) = (meets_m(-1.0), meets_m(1.0));
                        assert!(
                            (near_m - 0.05..far_m + 0.05).contains(&plane_m),
                            "{plane_m} m, not {near_m} to {far_m}"
                        );
                    } else {
                        assert!(plane_m < farthest + 0.04, "{plane_m} m behind the wall at {farthest} m");
                        errors.push(plane_m - wall_m[1]);
                    }
                }
            }
        }
        let (mean, deviation) = mean_and_deviation(&errors);
        println!(
            "hangs {hangs}: {} on walls, {floor} on the floor, of {cells}; {mean:.4} ± {deviation:.4} m",
            errors.len()
        );
        assert!(mean.abs() < 0.02 && deviation < 0.05, "{mean} ± {deviation} m");
        // Three of four cells have a return; on its head most of the rings look to the floor.
        let filled = (errors.len() + floor) as f64 / f64::from(cells);
        assert!(filled > 0.72, "{filled}");
        assert_eq!(hangs, floor * 5 > errors.len(), "{floor} on the floor, {} on walls", errors.len());
    }
}

/// Lost datagrams are counted by the clock.
#[test]
fn dropped_livox_datagrams_are_counted() {
    let mut decoder = Decoder::new(&DEFAULT_ELEVATIONS_MDEG);
    let arrived = datagrams(true, 2_000_000, Some("lidar:drop=5%"));
    for (at_us, bytes) in &arrived {
        let _ = decoder.decode(bytes, Stamp::from_micros(*at_us));
    }
    let sent = 2_000_000 / 480;
    let missing = sent - arrived.len();
    // Losses of the first turn are not counted.
    assert!(missing > 150 && decoder.counters().lost as usize <= missing, "{missing}");
    assert!(decoder.counters().lost as usize + 20 > missing, "{:?} of {missing}", decoder.counters());
}

fn drive(scenario: Scenario, seconds: u64, fault: Option<&str>) -> (f64, u32, u64) {
    let plan = Plan::of("livox", scenario, 1, seconds * 1_000_000).unwrap();
    let mut plan = plan.with_lidar(&livox_keys()).unwrap();
    plan.faults.extend(fault.map(|text| FaultSpec::parse(text).unwrap()));
    let mut show = |_: f64, _: &_, _: usize, _: &[_]| {};
    let mut observer = Observer::new(&plan, &mut show);
    run_virtual(&plan, &mut observer).unwrap();
    let verdict = observer.into_observation().verdict;
    (verdict.distance_m, verdict.bodies.counts.while_moving(), u64::from(verdict.stops))
}

/// Without its lidar, or with one that repeats what it saw, the robot does not drive on.
#[test]
fn robot_with_a_livox_needs_it() {
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/../hal-sim/scenarios/hazards/board-70.toml");
    let board = || load_scenario(path.as_ref()).unwrap();
    let (distance_with_m, contacts, _) = drive(board(), 10, None);
    assert!(distance_with_m > 2.0 && contacts == 0, "{distance_with_m} m, {contacts} contacts");
    let (distance_m, ..) = drive(board(), 10, Some("lidar:drop=100%"));
    assert!(distance_m < 0.05, "{distance_m} m without the lidar");
    // From 3 s on it repeats itself, says nothing, or another sensor speaks in its place: the robot stops there.
    for fault in ["stuck", "silent", "stranger"] {
        let (faulty_m, contacts, _) = drive(board(), 10, Some(&format!("lidar:{fault},from=3s")));
        assert!(
            contacts == 0 && faulty_m < 0.6 * distance_with_m,
            "{fault}: {faulty_m} m, {contacts} contacts"
        );
    }
    // Datagrams come twice, in another order, damaged or late: nothing is driven into.
    for fault in ["duplicate=50%", "reorder=20%", "flip=5%", "delay=120ms"] {
        let (_, contacts, _) = drive(board(), 10, Some(&format!("lidar:{fault},from=3s")));
        assert_eq!(contacts, 0, "{fault}");
    }
}
