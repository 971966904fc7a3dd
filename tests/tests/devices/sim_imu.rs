//! The driver of the Xsens MTi against the simulator's device, which was written from the description of the format
//! alone.

use std::collections::BTreeMap;

use crate::sim_support::{DrivenSimulation, bytes_of, mean_and_deviation, room};
use floorguard_drivers::xsens::{Device, DeviceEvent, DevicePhase};
use floorguard_sim::faults::{FaultLayer, FaultSpec};
use floorguard_sim::{Stream, Truth, WireEvent};
use floorguard_types::geometry::Pose2;
use floorguard_types::sensing::ImuSample;
use floorguard_types::time::{Age, Stamp};

/// A robot with an inertial sensor, a line that may be bad, and the truth at each millisecond.
struct Rig {
    seat: DrivenSimulation,
    device: Device,
    faults: FaultLayer,
    samples: Vec<ImuSample>,
    others: Vec<DeviceEvent>,
    truths: BTreeMap<u64, Truth>,
    /// What the host writes does not reach the device.
    deaf: bool,
}

impl Rig {
    fn new(seed: u64, faults: &[&str]) -> Self {
        let specs: Vec<FaultSpec> = faults.iter().map(|text| FaultSpec::parse(text).unwrap()).collect();
        Self {
            seat: DrivenSimulation::new(&room(Pose2::new(-1.0, -1.5, 0.3)), seed),
            device: Device::new(115_200),
            faults: FaultLayer::new(&specs, seed),
            samples: Vec::new(),
            others: Vec::new(),
            truths: BTreeMap::new(),
            deaf: false,
        }
    }

    fn run(&mut self, seconds: f64) {
        let end_us = self.seat.now_us() + (seconds * 1.0e6) as u64;
        while self.seat.now_us() < end_us {
            let mut arrived: Vec<WireEvent> = Vec::new();
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
                self.device.poll(Stamp::from_micros(now_us), &mut |frame| request.extend_from_slice(frame));
                if !self.deaf && !request.is_empty() {
                    self.seat.simulation.receive(Stream::ImuSerial, &request);
                }
            }
            self.truths.insert(now_us, self.seat.simulation.truth());
        }
    }

    /// The truth at the millisecond nearest to a stamp.
    fn truth_at(&self, stamp: Stamp) -> &Truth {
        let at_us = (stamp.as_micros() + 500) / 1_000 * 1_000;
        self.truths.get(&at_us).unwrap_or_else(|| panic!("no truth at {at_us} us"))
    }

    fn newest(&self) -> Stamp {
        self.samples.last().map_or(Stamp::ZERO, |sample| sample.stamp)
    }
}

#[test]
fn handshake_leads_to_hundred_samples_per_second() {
    let mut rig = Rig::new(3, &[]);
    rig.run(0.2);
    assert_eq!(rig.device.phase(), DevicePhase::Measuring);
    assert_eq!((rig.device.identifier(), rig.device.fault()), (0x0378_002A, None));
    rig.samples.clear();
    rig.run(5.0);
    assert!((499..=501).contains(&rig.samples.len()), "{}", rig.samples.len());
    assert!(rig.samples.windows(2).all(|pair| pair[1].sequence == pair[0].sequence.wrapping_add(1)));
    assert_eq!(rig.device.counters().lost_samples + rig.device.counters().incomplete, 0);
    assert_eq!(rig.device.frames().checksum_failures, 0);
    assert_eq!(rig.others, []);
    assert!(rig.samples.iter().all(|sample| !sample.suspect && sample.orientation.is_some()));
}

/// Samples are taken at whole hundredths of the world's second; the driver must say so although the line delays them by
/// 6.9 ms. Half a millisecond is the doubt about the device's latency.
#[test]
fn stamps_are_the_sampling_instants() {
    let mut rig = Rig::new(4, &[]);
    rig.run(10.0);
    for sample in &rig.samples {
        let us = sample.stamp.as_micros();
        let error_us = (us + 5_000) % 10_000;
        assert!((4_200..=5_200).contains(&error_us), "{us}");
    }
}

#[test]
fn samples_equal_motion_within_device_noise() {
    let mut rig = Rig::new(5, &[]);
    rig.run(1.0);
    rig.seat.drive(0.6, 0.7);
    rig.run(8.0);
    rig.seat.drive(0.5, -0.9);
    rig.run(8.0);
    let bias = f64::from(rig.seat.simulation.imu().bias_radps());
    let (mut turn, mut roll, mut up, mut heading, mut fastest) = (vec![], vec![], vec![], vec![], 0.0_f32);
    for sample in &rig.samples {
        let truth = rig.truth_at(sample.stamp);
        fastest = fastest.max(truth.twist.angular_radps.abs());
        turn.push(f64::from(sample.angular_radps[2] - truth.twist.angular_radps) - bias);
        roll.push(f64::from(sample.angular_radps[0]));
        up.push(f64::from(sample.linear_mps2[2]) - 9.81);
        let [w, x, y, z] = sample.orientation.unwrap();
        assert_eq!((x, y), (0.0, 0.0));
        let yaw = 2.0 * z.atan2(w);
        heading.push(f64::from(floorguard_types::geometry::wrap_angle(yaw - truth.robot.heading_rad)));
    }
    assert!(fastest > 0.4, "the robot turned: {fastest}");
    // The simulator's device: 0.003 rad/s and 0.02 m/s² of white noise, no error of the orientation.
    for (name, values, sigma) in [("turn", &turn, 0.003), ("roll", &roll, 0.003), ("up", &up, 0.02)] {
        let (mean, deviation) = mean_and_deviation(values);
        assert!(
            mean.abs() < 4.0 * sigma / (values.len() as f64).sqrt() + 0.02 * sigma,
            "{name}: mean {mean}"
        );
        assert!((0.94..1.06).contains(&(deviation / sigma)), "{name}: deviation {deviation}");
    }
    // Half a millisecond of a turn of 0.5 rad/s.
    assert!(heading.iter().all(|error| error.abs() < 0.001), "{heading:?}");
    // The sensor sits 0.3 m in front of the axle: centripetal part of the drive, tangential part of the turn.
    let left: Vec<f64> = rig
        .samples
        .iter()
        .filter(|sample| (1_000_000..16_900_000).contains(&sample.stamp.as_micros()))
        .map(|sample| {
            let turn_at = |stamp: Stamp| rig.truth_at(stamp).twist.angular_radps;
            let (before, after) = (sample.stamp.minus_micros(5_000), sample.stamp.plus_micros(5_000));
            let turn_radps2 = (turn_at(after) - turn_at(before)) / 0.01;
            let twist = rig.truth_at(sample.stamp).twist;
            f64::from(sample.linear_mps2[1] - twist.linear_mps * twist.angular_radps - 0.3 * turn_radps2)
        })
        .collect();
    let (mean, deviation) = mean_and_deviation(&left);
    assert!(mean.abs() < 0.003 && deviation < 0.025, "left: mean {mean}, deviation {deviation}");
}

/// Half a second without power, three seconds later everything is as before, and the clock of the device, which began
/// at zero again, is believed.
#[test]
fn a_power_cycle_is_survived() {
    let mut rig = Rig::new(6, &[]);
    rig.run(2.0);
    rig.seat.simulation.power_cycle_imu(500_000);
    let before = rig.samples.len();
    rig.run(0.7);
    assert!(rig.samples.len() <= before + 1, "at most one sample was still on the line");
    rig.run(0.5);
    assert_eq!(rig.device.phase(), DevicePhase::Measuring);
    rig.samples.clear();
    rig.run(3.0);
    assert!((299..=301).contains(&rig.samples.len()), "{}", rig.samples.len());
    assert!(
        rig.samples
            .iter()
            .all(|sample| (4_200..=5_200).contains(&((sample.stamp.as_micros() + 5_000) % 10_000)))
    );
    assert_eq!(rig.device.counters().lost_samples, 0, "a restart is no loss");
}

/// A short loss of power during which the wake-up message itself is lost on the line: the device measures by itself.
#[test]
fn a_lost_wake_up_message_is_survived() {
    let mut rig = Rig::new(7, &["imu:silent,from=2s,to=2.9s"]);
    rig.run(2.0);
    rig.seat.simulation.power_cycle_imu(50_000);
    rig.run(3.0);
    assert_eq!(rig.device.phase(), DevicePhase::Measuring);
    assert!(matches!(rig.newest().age(Stamp::from_micros(5_000_000)), Age::Past(us) if us < 20_000));
}

/// The line to the device is cut, the line from it is not: its data are used all the same, and the fault is
/// reported.
#[test]
fn deaf_device_is_used_unconfigured() {
    let mut rig = Rig::new(8, &[]);
    rig.deaf = true;
    rig.run(6.0);
    assert_eq!(rig.device.phase(), DevicePhase::Measuring);
    assert!(rig.device.fault().is_some());
    // It waits half a second for the acknowledgement before it measures by itself.
    assert!((545..=550).contains(&rig.samples.len()), "{}", rig.samples.len());
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
        let lost = rig.device.counters().lost_samples;
        let expected = if fault.contains("duplicate") { 0..=0 } else { 60..=200 };
        assert!(expected.contains(&lost), "{fault}: {lost} lost");
        let unique = rig.samples.len() - rig.device.counters().repeated_samples as usize;
        assert!((1_980..=2_001).contains(&(unique + lost as usize)), "{fault}: {unique} and {lost} lost");
        // The wake-up message begins the second one, its duplicate a third.
        assert!(rig.device.counters().starts <= 3, "{fault}: {}", rig.device.counters().starts);
        // A wrong length holds up no more than the frame that it pretends: four samples.
        let longest_us =
            rig.samples.windows(2).map(|pair| pair[1].stamp.as_micros() - pair[0].stamp.as_micros());
        assert!(longest_us.max().unwrap() <= 80_000, "{fault}");
    }
}

/// A line that is down for two seconds and up for two.
#[test]
fn a_flapping_line_is_survived() {
    let mut rig = Rig::new(10, &["imu:flap=4s"]);
    rig.run(20.0);
    assert!(rig.samples.len() > 800, "{}", rig.samples.len());
    assert!(rig.device.counters().starts >= 5);
    assert!(rig.samples.iter().all(|sample| (sample.linear_mps2[2] - 9.81).abs() < 0.12));
}
