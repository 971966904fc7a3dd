//! The driver of the VectorNav against the simulator's device, which was written from the description of the format alone.

use crate::sim_support::{DrivenSimulation, bytes_of, mean_and_deviation, room};
use floorguard_drivers::vectornav::{Device, DeviceEvent, DeviceFault, DevicePhase};
use floorguard_sim::Stream;
use floorguard_sim::faults::{FaultLayer, FaultSpec};
use floorguard_sim::robot::{ImuDevice, RobotParameters};
use floorguard_types::geometry::Pose2;
use floorguard_types::sensing::ImuSample;
use floorguard_types::time::{Age, Stamp};

/// A robot with the sensor, a line that may be bad, and how it really turned.
struct Rig {
    seat: DrivenSimulation,
    device: Device,
    faults: FaultLayer,
    samples: Vec<ImuSample>,
    others: Vec<DeviceEvent>,
    /// What the host writes does not reach the device.
    deaf: bool,
}

impl Rig {
    fn new(seed: u64, faults: &[&str]) -> Self {
        let specs: Vec<FaultSpec> = faults.iter().map(|text| FaultSpec::parse(text).unwrap()).collect();
        let robot = RobotParameters { imu_device: ImuDevice::VectorNav, ..RobotParameters::default() };
        Self {
            seat: DrivenSimulation::with_robot(&room(Pose2::new(-1.0, -1.5, 0.3)), seed, robot),
            device: Device::new(115_200),
            faults: FaultLayer::new(&specs, seed),
            samples: Vec::new(),
            others: Vec::new(),
            deaf: false,
        }
    }

    fn run(&mut self, seconds: f64) {
        let end_us = self.seat.now_us() + (seconds * 1.0e6) as u64;
        while self.seat.now_us() < end_us {
            let mut arrived = Vec::new();
            for event in self.seat.step() {
                self.faults.pass(event, &mut |event| arrived.push(event));
            }
            self.faults.release(self.seat.now_us(), &mut |event| arrived.push(event));
            for event in &arrived {
                let Some(bytes) = bytes_of(event, Stream::ImuSerial) else { continue };
                let (samples, others) = (&mut self.samples, &mut self.others);
                self.device.push(bytes, Stamp::from_micros(event.at_us), |event| match event {
                    DeviceEvent::Sample(sample) => samples.push(sample),
                    other => others.push(other),
                });
            }
            let now_us = self.seat.now_us();
            if now_us.is_multiple_of(10_000) {
                let mut request = Vec::new();
                self.device.poll(Stamp::from_micros(now_us), &mut |bytes| request.extend_from_slice(bytes));
                if !self.deaf && !request.is_empty() {
                    self.seat.simulation.receive(Stream::ImuSerial, &request);
                }
            }
        }
    }
}

#[test]
fn delivered_device_is_set_up_and_measures() {
    let mut rig = Rig::new(3, &[]);
    rig.run(0.3);
    assert_eq!((rig.device.phase(), rig.device.fault()), (DevicePhase::Measuring, None));
    rig.samples.clear();
    rig.run(5.0);
    assert!((499..=501).contains(&rig.samples.len()), "{}", rig.samples.len());
    assert!(rig.samples.windows(2).all(|pair| pair[1].sequence == pair[0].sequence.wrapping_add(1)));
    assert_eq!((rig.device.counters().lost_samples, rig.device.line().checksum_failures), (0, 0));
    assert_eq!(rig.others, []);
    assert!(rig.samples.iter().all(|sample| !sample.suspect && sample.orientation.is_none()));
    // Whole hundredths of the world's second, but for the doubt about the device's latency.
    for sample in &rig.samples {
        let error_us = (sample.stamp.as_micros() + 5_000) % 10_000;
        assert!((3_500..=6_000).contains(&error_us), "{error_us}");
    }
}

/// To the left is positive about an axis that points up, whatever the device calls it.
#[test]
fn samples_equal_motion_within_device_noise() {
    let mut rig = Rig::new(5, &[]);
    rig.seat.drive(0.6, 0.7);
    // By then it turns evenly.
    rig.run(3.0);
    rig.samples.clear();
    let bias = f64::from(rig.seat.simulation.imu().bias_radps());
    let (mut turn, mut up, mut fastest) = (vec![], vec![], 0.0_f32);
    for _ in 0..800 {
        let before = rig.samples.len();
        rig.run(0.01);
        let truth = rig.seat.simulation.truth().twist;
        fastest = fastest.max(truth.angular_radps);
        turn.extend(
            rig.samples[before..]
                .iter()
                .map(|sample| f64::from(sample.angular_radps[2] - truth.angular_radps) - bias),
        );
        up.extend(rig.samples[before..].iter().map(|sample| f64::from(sample.linear_mps2[2]) - 9.81));
    }
    assert!(fastest > 0.4, "the robot turned to the left: {fastest}");
    for (name, values, sigma) in [("turn", &turn, 0.003), ("up", &up, 0.02)] {
        let (mean, deviation) = mean_and_deviation(values);
        assert!(mean.abs() < 0.15 * sigma, "{name}: mean {mean}");
        assert!((0.9..1.1).contains(&(deviation / sigma)), "{name}: deviation {deviation}");
    }
}

/// Half a second without power takes its settings with it; it is set up again, and its clock, which began anew, is believed.
#[test]
fn a_power_cycle_is_survived() {
    let mut rig = Rig::new(6, &[]);
    rig.run(2.0);
    rig.seat.simulation.power_cycle_imu(500_000);
    rig.run(2.5);
    assert_eq!((rig.device.phase(), rig.device.counters().starts), (DevicePhase::Measuring, 2));
    rig.samples.clear();
    rig.run(3.0);
    assert!((299..=301).contains(&rig.samples.len()), "{}", rig.samples.len());
    assert!(matches!(
        rig.samples.last().map(|sample| sample.stamp.age(Stamp::from_micros(rig.seat.now_us()))),
        Some(Age::Past(us)) if us < 20_000
    ));
    assert_eq!(rig.device.counters().lost_samples, 0, "a restart is no loss");
}

/// The line to the device is cut: as delivered it sends text alone, which says nothing of use, and the robot knows.
#[test]
fn deaf_device_as_delivered_gives_nothing() {
    let mut rig = Rig::new(8, &[]);
    rig.deaf = true;
    rig.run(4.0);
    assert!(rig.samples.is_empty() && rig.device.line().sentences > 100, "{:?}", rig.device.line());
    assert_ne!(rig.device.phase(), DevicePhase::Measuring);
    // Cut later, its samples are used as they come.
    let mut rig = Rig::new(8, &[]);
    rig.run(1.0);
    rig.deaf = true;
    rig.device = Device::new(115_200);
    rig.samples.clear();
    rig.run(3.0);
    assert!((299..=301).contains(&rig.samples.len()), "{}", rig.samples.len());
    assert_eq!(rig.device.fault(), Some(DeviceFault::NoAnswer));
}

/// Bit errors, cut frames and lost portions: what is delivered is right, the rest is counted, nothing stands still.
#[test]
fn noise_costs_samples_and_never_falsifies_them() {
    for fault in ["imu:flip=5%", "imu:truncate=5%", "imu:drop=5%", "imu:duplicate=5%"] {
        let mut rig = Rig::new(9, &[fault]);
        rig.run(20.0);
        let bias = rig.seat.simulation.imu().bias_radps();
        for sample in &rig.samples {
            assert!((sample.angular_radps[2] - bias).abs() < 0.02, "{fault}: {sample:?}");
            assert!((sample.linear_mps2[2] - 9.81).abs() < 0.12, "{fault}: {sample:?}");
        }
        assert!(rig.samples.windows(2).all(|pair| pair[0].stamp <= pair[1].stamp), "{fault}");
        let counters = rig.device.counters();
        let expected = if fault.contains("duplicate") { 0..=0 } else { 60..=240 };
        assert!(expected.contains(&counters.lost_samples), "{fault}: {counters:?}");
        assert!(rig.samples.len() > 1_700 && counters.starts <= 2, "{fault}: {counters:?}");
    }
}

/// Numbers beyond measure are refused, another layout is no frame, a clock that jumps is a new device.
#[test]
fn edited_frames_are_no_samples() {
    let mut rig = Rig::new(10, &["imu:extreme,from=1s,to=2s"]);
    rig.run(3.0);
    assert!(rig.device.counters().refused > 20, "{:?}", rig.device.counters());
    assert!(rig.samples.iter().all(|sample| sample.linear_mps2.iter().all(|number| number.is_finite())));
    let mut rig = Rig::new(11, &["imu:stranger,from=1s,to=1.5s"]);
    rig.run(3.0);
    assert!((180..=260).contains(&rig.samples.len()), "{}", rig.samples.len());
}

/// A clock that is wrong, runs away, stands still, or a line that is late: no sample is ever of the future, and afterwards they are
/// fresh again.
#[test]
fn lying_clocks_never_reach_into_the_future() {
    for fault in ["past=500ms", "future=500ms", "drift=5%", "stuck", "delay=100ms"] {
        let mut rig = Rig::new(12, &[&format!("imu:{fault},from=1s,to=4s")]);
        for _ in 0..80 {
            let before = rig.samples.len();
            rig.run(0.1);
            let now = Stamp::from_micros(rig.seat.now_us());
            let is_past = |sample: &ImuSample| matches!(sample.stamp.age(now), Age::Past(_));
            assert!(rig.samples[before..].iter().all(is_past), "{fault}");
        }
        let last = rig.samples.last().map(|sample| sample.stamp.age(Stamp::from_micros(rig.seat.now_us())));
        assert!(matches!(last, Some(Age::Past(us)) if us < 20_000), "{fault}: {last:?}");
        assert_eq!(rig.device.phase(), DevicePhase::Measuring, "{fault}");
    }
}
