//! A scanner behind a bridge, against the simulator's own encoder of the scan link, and a robot that drives behind it.

use crate::sim_support::{mean_and_deviation, room, wall_range_m};
use floorguard_configuration::BRIDGED_EXAMPLE;
use floorguard_drivers::ranging::{Bridged, RangingEvent, RangingScanner};
use floorguard_laboratory::plan::Plan;
use floorguard_laboratory::world::{Observer, run_virtual};
use floorguard_runtime::configuration::{RangingModel, ScannerModel};
use floorguard_sim::robot::{BridgedScans, RobotParameters, ScannerDevice};
use floorguard_sim::{FaultSpec, Payload, Scenario, Simulation, Stream};
use floorguard_types::geometry::{Point2, Pose2};
use floorguard_types::sensing::{BeamReturn, Scan};
use floorguard_types::time::Stamp;

const START: Pose2 = Pose2 { x_m: 0.7, y_m: -0.4, heading_rad: 0.5 };
/// The scanner's place on the robot, metres forward.
const MOUNT_M: f32 = 0.90;

/// Complete scans until a time; each `loss_interval`-th datagram is dropped, none for 0.
fn scans(until_us: u64, loss_interval: usize) -> (Vec<(u64, Scan)>, Bridged) {
    let shape = BRIDGED_EXAMPLE;
    let device = ScannerDevice::Bridged(BridgedScans {
        beams: shape.beams,
        first_udeg: shape.first_udeg,
        step_udeg: shape.step_udeg,
        period_us: shape.period_us,
        range_mm: shape.range_mm,
    });
    let parameters = RobotParameters { scanner_device: device, ..RobotParameters::default() };
    let mut simulation = Simulation::with_robot(&room(START), 5, parameters).unwrap();
    let mut scanner = Bridged::new(shape);
    let (mut found, mut datagrams) = (Vec::new(), 0);
    simulation.advance_to(until_us, &mut |event| {
        let (Stream::ScannerData, Payload::Bytes(bytes)) = (event.stream, &event.payload) else { return };
        datagrams += 1;
        assert!(bytes.len() <= 1_472);
        if loss_interval > 0 && datagrams % loss_interval == 0 {
            return;
        }
        scanner.push(bytes, Stamp::from_micros(event.at_us), &mut |heard| match heard {
            RangingEvent::Scan(scan) => found.push((event.at_us, scan.clone())),
            other => panic!("{other:?}"),
        });
    });
    (found, scanner)
}

#[test]
fn bridged_scans_meet_the_walls() {
    let (scans, scanner) = scans(2_000_000, 0);
    assert!((18..20).contains(&scans.len()), "{} scans", scans.len());
    assert_eq!(scanner.decoder().counters().lost, 0);
    let sensor = START.compose(Pose2::new(MOUNT_M, 0.0, 0.0));
    let mut errors = Vec::new();
    for (arrived_us, scan) in &scans {
        assert_eq!(scan.beams.len(), 1_440);
        // The middle of a turn of 100 ms; the delay of 6 ms is not seen by the clocks, that of two more datagrams is.
        let age_us = arrived_us - scan.stamp.as_micros();
        assert!((49_900..50_500).contains(&age_us), "{age_us} us");
        for (index, beam) in scan.beams.iter().enumerate() {
            let BeamReturn::Hit(range_mm) = beam else { continue };
            let bearing = f64::from(sensor.heading_rad + scan.first_angle_rad + index as f32 * scan.step_rad);
            let wall_m = wall_range_m(Point2::new(sensor.x_m, sensor.y_m), bearing);
            errors.push(f64::from(*range_mm) * 1.0e-3 - wall_m);
        }
    }
    let (mean, deviation) = mean_and_deviation(&errors);
    println!("{} returns, mean {mean:.4} m, deviation {deviation:.4} m", errors.len());
    assert!(mean.abs() < 0.002 && deviation < 0.12, "mean {mean} m, deviation {deviation} m");
    assert!(errors.len() > scans.len() * 700, "{} returns", errors.len());
}

/// Of a scan of three datagrams one is lost: the scan is, and it is counted.
#[test]
fn incomplete_scans_do_not_come_out() {
    let (scans, scanner) = scans(4_000_000, 7);
    let counters = scanner.decoder().counters();
    println!("{counters:?}");
    assert_eq!(scans.len(), counters.scans as usize);
    assert!((15..18).contains(&counters.lost) && (20..25).contains(&counters.scans), "{counters:?}");
}

/// Between walls within its range the robot drives, no faster than its file says. It stands without scans, with half of each, and with
/// ranges that cannot be.
#[test]
fn robot_behind_a_bridge_is_slow_or_stands() {
    const ROOM: &str = "
title = \"a closed room\"
[route]
speed_mps = 0.8
waypoints_m = [[8.0, 0.0]]
[scene]
wall = [
  { from_m = [-3.0, -4.0], to_m = [12.0, -4.0] },
  { from_m = [-3.0, 4.0], to_m = [12.0, 4.0] },
  { from_m = [-3.0, -4.0], to_m = [-3.0, 4.0] },
  { from_m = [12.0, -4.0], to_m = [12.0, 4.0] },
]
";
    let drive = |fault: Option<&str>| {
        let scenario = Scenario::from_toml(ROOM).unwrap();
        let plan = Plan::of("room", scenario, 1, 8_000_000).unwrap();
        let mut plan =
            plan.with_scanner(ScannerModel::Ranging(RangingModel::Bridged(BRIDGED_EXAMPLE))).unwrap();
        plan.lidar_grain = 4;
        plan.faults.extend(fault.map(|text| FaultSpec::parse(text).unwrap()));
        let mut show = |_: f64, _: &_, _: usize, _: &[_]| {};
        let mut observer = Observer::new(&plan, &mut show);
        run_virtual(&plan, &mut observer).unwrap();
        observer.into_observation().verdict.distance_m
    };
    let slow_m = drive(None);
    println!("{slow_m:.3} m");
    assert!((0.6..2.5).contains(&slow_m), "{slow_m} m in 8 s at 0.3 m/s");
    for fault in ["scanner:drop=100%", "scanner:rate=2", "scanner:blind=60", "scanner:extreme=100%"] {
        let lost_m = drive(Some(fault));
        println!("{fault}: {lost_m:.3} m");
        assert!(lost_m < 0.05, "{fault}: {lost_m} m");
    }
}
