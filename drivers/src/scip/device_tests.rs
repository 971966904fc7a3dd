//! A sensor that answers as the specification says, and one that does not.

use super::receiver_tests::scan_reply;
use super::*;
use floorguard_types::sensing::BeamReturn;
use floorguard_types::time::Stamp;
use std::string::String;
use std::vec::Vec;

fn at(micros: u64) -> Stamp {
    Stamp::from_micros(micros)
}

const PARAMETERS: &str =
    "PP\n00P\nDMIN:20;4\nDMAX:5600;_\nARES:1024;\\\nAMIN:44;7\nAMAX:725;o\nAFRT:384;6\nSCAN:600;e\n\n";

/// A URG that answers after 2 ms; its counter began at a number, and a scan is sent 110 ms after step 0.
struct Sensor {
    device: Device,
    now_us: u64,
    counter: u64,
    is_scanning: bool,
    is_mute: bool,
    asked: Vec<String>,
    scans: Vec<MeasuredScan>,
    others: Vec<String>,
}

impl Sensor {
    fn new(counter: u64) -> Self {
        Self {
            device: Device::new(DeviceConfiguration::URG_04LX),
            now_us: 1_000_000,
            counter,
            is_scanning: false,
            is_mute: false,
            asked: Vec::new(),
            scans: Vec::new(),
            others: Vec::new(),
        }
    }

    fn counter_at(&self, micros: u64) -> u32 {
        ((self.counter + micros / 1_000) % (1 << 24)) as u32
    }

    fn send(&mut self, bytes: &[u8], at_us: u64) {
        let (scans, others) = (&mut self.scans, &mut self.others);
        self.device.push(bytes, at(at_us), |event| match event {
            DeviceEvent::Scan(scan) => scans.push(scan.clone()),
            other => others.push(std::format!("{other:?}")),
        });
    }

    /// A millisecond.
    fn step(&mut self) {
        self.now_us += 1_000;
        let mut sent = Vec::new();
        self.device.poll(at(self.now_us), &mut |bytes| sent.extend_from_slice(bytes));
        if self.is_mute {
            return;
        }
        for command in String::from_utf8(sent).unwrap().lines() {
            self.asked.push(command.into());
            let heard_us = self.now_us + 1_000;
            let answer = match command {
                "SCIP2.0" => "SCIP2.0\n0Eu\n\n".into(),
                "PP" => PARAMETERS.into(),
                "TM1" => {
                    let time = self.counter_at(heard_us);
                    let characters: String = (0..4)
                        .rev()
                        .map(|place| char::from((time >> (6 * place) & 0x3F) as u8 + 0x30))
                        .collect();
                    let sum = char::from(check_character(characters.as_bytes()));
                    std::format!("TM1\n00P\n{characters}{sum}\n\n")
                }
                _ => {
                    self.is_scanning = command.starts_with("MD");
                    std::format!("{command}\n00P\n\n")
                }
            };
            self.send(answer.as_bytes(), self.now_us + 2_000);
        }
        if self.is_scanning && self.now_us.is_multiple_of(100_000) {
            let values: Vec<u32> = (0..511).map(|step| if step == 255 { 7 } else { 1_000 + step }).collect();
            let begun = self.counter_at(self.now_us - 110_000);
            let bytes = scan_reply("MD0129063901000", "99", begun, &values);
            self.send(&bytes, self.now_us);
        }
    }
}

#[test]
fn it_measures_with_times_of_the_robot() {
    for counter in [0, 1_234_567, (1 << 24) - 2_000] {
        let mut sensor = Sensor::new(counter);
        for _ in 0..4_000 {
            sensor.step();
        }
        assert_eq!(sensor.device.phase(), DevicePhase::Measuring);
        assert_eq!(sensor.asked[..3], ["SCIP2.0", "QT", "PP"]);
        assert_eq!(sensor.asked.last().unwrap(), "MD0129063901000");
        assert!(sensor.scans.len() > 30 && sensor.device.counters().restarts == 0, "{}", sensor.scans.len());
        assert_eq!(sensor.device.clock_uncertainty_us(), Some(1_000));
        for scan in &sensor.scans {
            // Step 129 passes 12.6 ms after step 0.
            let begun_us = scan.first_beam.as_micros() as f64 - 129.0 * 97.656_25;
            // It began 110 ms before a full tenth of a second.
            let off_us = (begun_us + 110_000.0).rem_euclid(100_000.0);
            assert!(off_us.min(100_000.0 - off_us) <= 1_600.0, "{off_us}");
            assert_eq!(scan.beams.len(), 511);
            assert_eq!((scan.beams[0], scan.beams[255]), (BeamReturn::Hit(1_000), BeamReturn::Unknown));
            assert!((scan.first_angle_rad + 255.0 * scan.step_rad).abs() < 1e-6);
            assert!((scan.beam_period_us - 97.656_25).abs() < 1e-3);
        }
    }
}

#[test]
fn a_silent_sensor_is_asked_again() {
    let mut sensor = Sensor::new(0);
    for _ in 0..2_000 {
        sensor.step();
    }
    sensor.is_mute = true;
    for _ in 0..4_000 {
        sensor.step();
    }
    assert!(sensor.device.counters().restarts >= 1 && sensor.device.phase() != DevicePhase::Measuring);
    let before = sensor.scans.len();
    (sensor.is_mute, sensor.is_scanning) = (false, false);
    for _ in 0..4_000 {
        sensor.step();
    }
    assert!(sensor.scans.len() > before + 10 && sensor.device.phase() == DevicePhase::Measuring);
}

#[test]
fn trouble_is_reported_and_left_alone() {
    let mut sensor = Sensor::new(0);
    for _ in 0..2_000 {
        sensor.step();
    }
    sensor.is_scanning = false;
    let trouble = [b"MD0129063901000\n50", &[check_character(b"50")][..], b"\n\n"].concat();
    let now = sensor.now_us;
    sensor.send(&trouble, now);
    assert_eq!(sensor.others.last().unwrap(), &std::format!("{:?}", DeviceEvent::Fault(Status::Trouble(50))));
    assert_eq!(sensor.device.phase(), DevicePhase::Resting);
    for _ in 0..4_000 {
        sensor.step();
    }
    assert_eq!(sensor.device.phase(), DevicePhase::Measuring);
}

#[test]
fn another_sensor_is_not_used() {
    let mut sensor = Sensor::new(0);
    let range = ScanRange { first_step: 0, last_step: 1_000, cluster: 1 };
    sensor.device = Device::new(DeviceConfiguration { range, ..DeviceConfiguration::URG_04LX });
    for _ in 0..3_000 {
        sensor.step();
    }
    assert!(sensor.scans.is_empty() && sensor.others.iter().any(|other| other.starts_with("Unsuitable")));
    // Scans of other steps than were asked for.
    let mut sensor = Sensor::new(0);
    for _ in 0..2_000 {
        sensor.step();
    }
    let (now, before) = (sensor.now_us, sensor.scans.len());
    sensor.send(&scan_reply("MD0129013001000", "99", 5, &[500, 600]), now);
    assert_eq!((sensor.scans.len(), sensor.device.counters().foreign), (before, 1));
}
