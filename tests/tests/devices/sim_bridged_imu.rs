//! An inertial sensor behind a bridge, against the simulator's own encoder of the IMU link, and a robot that drives with it.

use std::process::Command;

use crate::sim_support::{DrivenSimulation, bytes_of, mean_and_deviation, room};
use floorguard_drivers::imu_link::{Device, DeviceEvent};
use floorguard_laboratory::plan::Plan;
use floorguard_laboratory::world::{Observer, run_virtual};
use floorguard_runtime::configuration::ImuModel;
use floorguard_sim::robot::{ImuDevice, RobotParameters};
use floorguard_sim::{FaultSpec, Stream};
use floorguard_types::geometry::Pose2;
use floorguard_types::sensing::ImuSample;
use floorguard_types::time::Stamp;

/// To the left is positive about an axis that points up, and gravity is measured upward.
#[test]
fn bridged_samples_equal_motion_within_noise() {
    let robot = RobotParameters { imu_device: ImuDevice::Bridged, ..RobotParameters::default() };
    let mut seat = DrivenSimulation::with_robot(&room(Pose2::new(-1.0, -1.5, 0.3)), 5, robot);
    let mut device = Device::default();
    seat.drive(0.6, 0.7);
    let bias = f64::from(seat.simulation.imu().bias_radps());
    let (mut turn, mut up, mut fastest, mut sequence) = (vec![], vec![], 0.0_f32, None);
    while seat.now_us() < 11_000_000 {
        let mut samples: Vec<ImuSample> = Vec::new();
        for event in seat.step() {
            let Some(bytes) = bytes_of(&event, Stream::ImuSerial) else { continue };
            device.push(bytes, Stamp::from_micros(event.at_us), |found| match found {
                DeviceEvent::Sample(sample) => samples.push(sample),
                other => panic!("{other:?}"),
            });
        }
        let truth = seat.simulation.truth().twist;
        for sample in samples {
            assert!(sequence.is_none_or(|last: u16| sample.sequence == last.wrapping_add(1)));
            sequence = Some(sample.sequence);
            // By then it turns evenly.
            if seat.now_us() > 3_000_000 {
                fastest = fastest.max(truth.angular_radps);
                turn.push(f64::from(sample.angular_radps[2] - truth.angular_radps) - bias);
                up.push(f64::from(sample.linear_mps2[2]) - 9.81);
            }
        }
    }
    assert!(fastest > 0.4 && turn.len() > 780, "{fastest} rad/s, {} samples", turn.len());
    assert_eq!((device.counters().lost, device.counters().refused), (0, 0));
    for (name, values, sigma) in [("turn", &turn, 0.003), ("up", &up, 0.02)] {
        let (mean, deviation) = mean_and_deviation(values);
        println!("{name}: mean {mean:.5}, deviation {deviation:.5}");
        assert!(mean.abs() < 0.15 * sigma, "{name}: mean {mean}");
        assert!((0.9..1.1).contains(&(deviation / sigma)), "{name}: deviation {deviation}");
    }
}

/// The robot drives with it as with an MTi, and stands without it, and when its numbers are none or another bridge sends.
#[test]
fn robot_with_a_bridged_imu_drives() {
    let drive = |fault: Option<&str>| {
        let plan = Plan::named("corridor", 1, 6_000_000).unwrap();
        let mut plan = plan.with_imu(ImuModel::Bridged).unwrap();
        assert_eq!(plan.robot.imu.unwrap().model, ImuModel::Bridged);
        plan.lidar_grain = 4;
        plan.faults.extend(fault.map(|text| FaultSpec::parse(text).unwrap()));
        let mut show = |_: f64, _: &_, _: usize, _: &[_]| {};
        let mut observer = Observer::new(&plan, &mut show);
        run_virtual(&plan, &mut observer).unwrap();
        observer.into_observation().verdict.distance_m
    };
    let (driven_m, lost_m) = (drive(None), drive(Some("imu:drop=100%")));
    println!("{driven_m:.3} m, {lost_m:.3} m without its samples");
    assert!(driven_m > 1.0 && lost_m < 0.05, "{driven_m} m, {lost_m} m");
    for fault in ["imu:extreme,from=3s", "imu:stranger,from=3s"] {
        let edited_m = drive(Some(fault));
        println!("{edited_m:.3} m with {fault}");
        assert!(edited_m > 0.05 && edited_m < 0.8 * driven_m, "{fault}: {edited_m} m");
    }
}

/// The lines that an example prints as its vector; `None` where there is no Python.
fn vector(script: &str) -> Option<Vec<String>> {
    let script = format!("{}/../examples/{script}", env!("CARGO_MANIFEST_DIR"));
    let Ok(output) = Command::new("python3").args(["-B", &script, "--vector"]).output() else {
        println!("skipped: there is no python3");
        return None;
    };
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    Some(String::from_utf8(output.stdout).unwrap().lines().map(str::to_owned).collect())
}

/// A sample that turns to the left; one without rates and one that is no number are faults of the sensor.
#[test]
fn samples_of_ros_become_frames() {
    let Some(lines) = vector("ros2_imu_samples.py") else { return };
    let byte = |pair: &[u8]| u8::from_str_radix(std::str::from_utf8(pair).unwrap(), 16).unwrap();
    let (mut device, mut found) = (Device::default(), Vec::new());
    for (number, line) in (0_u64..).zip(&lines) {
        let bytes: Vec<u8> = line.as_bytes().chunks(2).map(byte).collect();
        device.push(&bytes, Stamp::from_micros(5_000_000 + number * 10_000), |event| found.push(event));
    }
    let [
        DeviceEvent::Sample(first),
        DeviceEvent::Error(1),
        DeviceEvent::Sample(second),
        DeviceEvent::Error(1),
        _,
    ] = found[..]
    else {
        panic!("{found:?}")
    };
    assert_eq!(
        (first.angular_radps, first.linear_mps2, first.suspect),
        ([0.0, 0.0, 0.5], [0.25, 0.0, 9.75], false)
    );
    assert!(second.suspect && second.stamp == Stamp::from_micros(5_010_000));
}

#[test]
fn book_has_the_reference_frame() {
    let Some(lines) = vector("imu_samples.py") else { return };
    let page = concat!(env!("CARGO_MANIFEST_DIR"), "/../docs/src/wire-formats/imu-link.md");
    let page = std::fs::read_to_string(page).unwrap();
    assert!(lines.len() == 1 && page.contains(&lines[0]), "{lines:?}");
}
