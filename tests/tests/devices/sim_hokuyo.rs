//! Hokuyo scanners as the scanner of the guard, against the simulator's sensor, which answers by the specification alone.

use crate::sim_support::{mean_and_deviation, room, wall_range_m};
use floorguard_drivers::ranging::{Hokuyo, RangingEvent, RangingScanner, UST_FULL};
use floorguard_laboratory::plan::Plan;
use floorguard_laboratory::world::{Observer, run_virtual};
use floorguard_runtime::configuration::{RangingModel, ScannerModel};
use floorguard_sim::robot::{HokuyoModel, RobotParameters, ScannerDevice};
use floorguard_sim::{FaultSpec, Payload, Scenario, Simulation, Stream};
use floorguard_types::geometry::{Point2, Pose2};
use floorguard_types::sensing::{BeamReturn, Scan};
use floorguard_types::time::Stamp;

const START: Pose2 = Pose2 { x_m: 0.7, y_m: -0.4, heading_rad: 0.5 };
/// The scanner's place on the robot, metres forward.
const MOUNT_M: f32 = 0.90;

/// Asks the simulated sensor as the robot does, every 20 ms.
fn scans(until_us: u64) -> Vec<(u64, Scan)> {
    let device = ScannerDevice::Hokuyo(HokuyoModel::Ust);
    let parameters = RobotParameters { scanner_device: device, ..RobotParameters::default() };
    let mut simulation = Simulation::with_robot(&room(START), 5, parameters).unwrap();
    let mut scanner = Hokuyo::new(UST_FULL);
    let mut found = Vec::new();
    for now_us in (1_000..until_us).step_by(1_000) {
        let mut arrived = Vec::new();
        simulation.advance_to(now_us, &mut |event| {
            if let (Stream::ScannerSerial, Payload::Bytes(bytes)) = (event.stream, event.payload) {
                arrived.push(bytes);
            }
        });
        let now = Stamp::from_micros(now_us);
        for bytes in arrived {
            scanner.push(&bytes, now, &mut |event| match event {
                RangingEvent::Scan(scan) => found.push((now_us, scan.clone())),
                other => panic!("{other:?}"),
            });
        }
        let mut sent = Vec::new();
        scanner.poll(now, &mut |bytes| sent.extend_from_slice(bytes), &mut |event| panic!("{event:?}"));
        simulation.receive(Stream::ScannerSerial, &sent);
    }
    found
}

#[test]
fn hokuyo_scans_meet_the_walls() {
    let scans = scans(1_500_000);
    assert!((45..60).contains(&scans.len()), "{} scans", scans.len());
    let sensor = START.compose(Pose2::new(MOUNT_M, 0.0, 0.0));
    let mut errors = Vec::new();
    for (arrived_us, scan) in &scans {
        assert_eq!((scan.beams.len(), scan.step_rad), (1_081, 0.25_f32.to_radians()));
        assert!((scan.first_angle_rad + 135.0_f32.to_radians()).abs() < 1.0e-5);
        // The middle of a turn of 25 ms of which 270° measure, sent 3 ms after its end.
        let age_us = arrived_us - scan.stamp.as_micros();
        assert!((11_000..18_000).contains(&age_us), "{age_us} us");
        for (index, beam) in scan.beams.iter().enumerate() {
            let BeamReturn::Hit(range_mm) = beam else { continue };
            let angle = scan.first_angle_rad + index as f32 * scan.step_rad;
            let bearing = f64::from(sensor.heading_rad + angle);
            errors.push(
                f64::from(*range_mm) * 1.0e-3 - wall_range_m(Point2::new(sensor.x_m, sensor.y_m), bearing),
            );
        }
    }
    let (mean, deviation) = mean_and_deviation(&errors);
    assert!(mean.abs() < 0.002 && deviation < 0.12, "mean {mean} m, deviation {deviation} m");
    assert!(errors.len() > scans.len() * 1_000, "{} returns", errors.len());
    assert!(scans.windows(2).all(|pair| pair[0].1.sequence != pair[1].1.sequence));
}

/// Between walls within its range the robot drives, no faster than its file says. Without its scanner it stands.
#[test]
fn robot_behind_a_hokuyo_is_slow_or_stands() {
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
        let mut plan = plan.with_scanner(ScannerModel::Ranging(RangingModel::HokuyoUst)).unwrap();
        plan.lidar_grain = 4;
        plan.faults.extend(fault.map(|text| FaultSpec::parse(text).unwrap()));
        let mut show = |_: f64, _: &_, _: usize, _: &[_]| {};
        let mut observer = Observer::new(&plan, &mut show);
        run_virtual(&plan, &mut observer).unwrap();
        observer.into_observation().verdict.distance_m
    };
    let slow_m = drive(None);
    assert!((0.6..2.5).contains(&slow_m), "{slow_m} m in 8 s at 0.3 m/s");
    let lost_m = drive(Some("scanner:drop=100%"));
    assert!(lost_m < 0.05, "{lost_m} m without the scanner");
}
