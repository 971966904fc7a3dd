//! Hokuyo scanners as the scanner of the guard, against the simulator's sensor, which answers by the specification alone.

use crate::sim_support::{mean_and_deviation, room, wall_range_m};
use floorguard_drivers::ranging::{Hokuyo, RangingEvent, RangingScanner, UST_FULL};
use floorguard_laboratory::plan::Plan;
use floorguard_laboratory::world::{Observer, load_scenario, run_virtual};
use floorguard_runtime::configuration::{RangingModel, RangingScanner, ScannerModel};
use floorguard_sim::robot::{HokuyoModel, RobotParameters, ScannerDevice};
use floorguard_sim::{FaultSpec, Payload, Simulation, Stream};
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

/// Where nothing comes back it is unknown, so the robot stands in a hall without end; its owner may accept that there is nothing. It then
/// drives no faster than its file says, and stands without its scanner.
#[test]
fn robot_behind_a_hokuyo_is_slow_or_stands() {
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/../hal-sim/scenarios/hazards/box-30.toml");
    let drive = |no_return_mm: u16, fault: Option<&str>| {
        let scenario = load_scenario(path.as_ref()).unwrap();
        let plan = Plan::of("box-30", scenario, 1, 8_000_000).unwrap();
        let scanner = RangingScanner { model: RangingModel::HokuyoUst, no_return_mm };
        let mut plan = plan.with_scanner(ScannerModel::Ranging(scanner)).unwrap();
        plan.lidar_grain = 4;
        plan.faults.extend(fault.map(|text| FaultSpec::parse(text).unwrap()));
        let mut show = |_: f64, _: &_, _: usize, _: &[_]| {};
        let mut observer = Observer::new(&plan, &mut show);
        run_virtual(&plan, &mut observer).unwrap();
        observer.into_observation().verdict.distance_m
    };
    let accepted_m = drive(4_000, None);
    assert!((0.6..2.5).contains(&accepted_m), "{accepted_m} m in 8 s at 0.3 m/s");
    let unknown_m = drive(0, None);
    assert!(unknown_m < 0.05, "{unknown_m} m where nothing comes back");
    let lost_m = drive(4_000, Some("scanner:drop=100%"));
    assert!(lost_m < 0.05, "{lost_m} m without the scanner");
}
