use super::*;
use crate::can::CanFrame;
use floorguard_types::time::Stamp;
use std::vec::Vec;

fn at(micros: u64) -> Stamp {
    Stamp::from_micros(micros)
}

/// A node that takes every write and starts, and an encoder that follows the command at once; frames of process data of the book,
/// CANopen: Process data.
struct Bench {
    motor: ScanMotor,
    events: Vec<ScanMotorEvent>,
    commands: Vec<(u16, i32)>,
    counts: f64,
    status: u16,
    now_us: u64,
    is_blocked: bool,
}

impl Bench {
    fn new() -> Self {
        let motor = ScanMotor::new(ScanMotorConfiguration::PUBLISHED);
        let (events, commands) = (Vec::new(), Vec::new());
        Self { motor, events, commands, counts: 0.0, status: 0x0250, now_us: 0, is_blocked: false }
    }

    fn hear(&mut self, id: u16, payload: &[u8]) {
        let events = &mut self.events;
        self.motor
            .on_frame(&CanFrame::standard(id, payload), at(self.now_us), &mut |event| events.push(event));
    }

    /// A millisecond.
    fn step(&mut self) {
        self.now_us += 1_000;
        let mut sent = Vec::new();
        let events = &mut self.events;
        self.motor.poll(at(self.now_us), &mut |event| events.push(event), &mut |frame| sent.push(*frame));
        if self.now_us.is_multiple_of(100_000) {
            self.hear(0x70B, &[5]);
        }
        for frame in sent {
            let payload = frame.payload();
            match (frame.standard_id().unwrap(), payload) {
                (0x60B, [0x40, a, b, c, ..]) => {
                    let answer = [0x43, *a, *b, *c, 0, 0, 0, 0];
                    self.hear(0x58B, &answer);
                }
                (0x60B, [_, a, b, c, ..]) => {
                    let answer = [0x60, *a, *b, *c, 0, 0, 0, 0];
                    self.hear(0x58B, &answer);
                }
                (0x20B, &[low, high, a, b, c, d]) => {
                    self.commands.push((u16::from_le_bytes([low, high]), i32::from_le_bytes([a, b, c, d])));
                    self.obey();
                }
                (0x080, _) => {
                    let ([low, high], [a, b, c, d]) =
                        (self.status.to_le_bytes(), (self.counts.round() as i32).to_le_bytes());
                    self.hear(0x18B, &[low, high, a, b, c, d]);
                }
                _ => {}
            }
        }
        if self.status == 0x0237 && !self.is_blocked {
            let (_, rpm) = self.commands.last().copied().unwrap_or_default();
            // 2,048 counts for a turn of the motor.
            self.counts += f64::from(rpm) / 60.0 * 2_048.0 * 1e-3;
        }
    }

    fn obey(&mut self) {
        self.status = match (self.status, self.commands.last().unwrap().0) {
            (0x0250, 0x06) => 0x0231,
            (0x0231, 0x07) => 0x0233,
            (0x0233, 0x0F) => 0x0237,
            (0x0218, 0x80) => 0x0250,
            (status, _) => status,
        };
    }

    fn angles(&self) -> Vec<(u64, f32, f32)> {
        let angle = |event: &ScanMotorEvent| match *event {
            ScanMotorEvent::Angle { stamp, angle_rad, commanded_radps } => {
                Some((stamp.as_micros(), angle_rad, commanded_radps))
            }
            _ => None,
        };
        self.events.iter().filter_map(angle).collect()
    }
}

#[test]
fn it_turns_between_its_limits() {
    let mut bench = Bench::new();
    for _ in 0..40_000 {
        bench.step();
    }
    let angles = bench.angles();
    assert!(angles.len() > 3_900, "{}", angles.len());
    let (low, high) =
        angles.iter().fold((0.0_f32, 0.0_f32), |(low, high), one| (low.min(one.1), high.max(one.1)));
    // Limits, and what it turns until the next report.
    assert!((1.963..1.972).contains(&high) && (-1.972..-1.963).contains(&low), "{low} {high}");
    let ends = bench.events.iter().filter(|event| **event == ScanMotorEvent::SweepEnd).count();
    assert_eq!(ends, 3, "6.5 s to the first end, 13.1 s to each further one");
    // 0.3 rad/s: 286 turns of the motor a minute.
    assert!(
        bench.commands.iter().any(|(_, rpm)| *rpm == 286)
            && bench.commands.iter().any(|(_, rpm)| *rpm == -286)
    );
    for pair in angles.windows(2) {
        assert_eq!(pair[1].0 - pair[0].0, 10_000);
        let turned = (pair[1].1 - pair[0].1) / 0.01;
        assert!(turned.abs() < 0.31, "{turned} rad/s");
    }
}

/// The first word never enables: each step is taken after the drive has reported the one before.
#[test]
fn it_is_enabled_step_by_step() {
    let mut bench = Bench::new();
    for _ in 0..300 {
        bench.step();
    }
    let mut words: Vec<u16> = bench.commands.iter().map(|(word, _)| *word).collect();
    words.dedup();
    assert_eq!(words, [0x00, 0x06, 0x07, 0x0F]);
    let enabled = bench.commands.iter().position(|(word, _)| *word == 0x0F).unwrap();
    assert!(bench.commands[..enabled].iter().all(|(_, rpm)| *rpm == 0), "no speed before it is enabled");
}

#[test]
fn faults_are_reported_once_and_left_on_demand() {
    let mut bench = Bench::new();
    for _ in 0..1_000 {
        bench.step();
    }
    bench.hear(0x08B, &[0x11, 0x73, 0x01, 0, 0, 0, 0, 0]);
    bench.status = 0x0218;
    for _ in 0..500 {
        bench.step();
    }
    let faults: Vec<_> =
        bench.events.iter().filter(|event| matches!(event, ScanMotorEvent::Fault(_))).collect();
    assert_eq!(faults, [&ScanMotorEvent::Fault(ScanMotorFault::Drive(0x7311))]);
    assert_eq!(bench.angles().last().unwrap().2, 0.0, "nothing is commanded");
    bench.motor.reset_fault();
    for _ in 0..500 {
        bench.step();
    }
    assert!(bench.motor.is_enabled());
}

#[test]
fn a_node_that_is_gone_is_reported() {
    let mut bench = Bench::new();
    for _ in 0..1_000 {
        bench.step();
    }
    let mut events = Vec::new();
    for millis in 0..3_000 {
        let now = at(bench.now_us + 1_000 * millis);
        bench.motor.poll(now, &mut |event| events.push(event), &mut |_| {});
    }
    assert_eq!(events, [ScanMotorEvent::Fault(ScanMotorFault::Lost)]);
    // An angle without a SYNC before it belongs to no time.
    bench.now_us += 4_000_000;
    let before = bench.motor.counters();
    bench.hear(0x18B, &[0x37, 0x02, 1, 2, 3, 4]);
    assert_eq!(bench.motor.counters().unusable, before.unusable + 1);
    assert_eq!(bench.motor.counters().angles, before.angles);
}

#[test]
fn angles_follow_gear_and_direction() {
    let published = ScanMotorConfiguration::PUBLISHED;
    assert!(published.is_plausible());
    assert!((published.angle_rad(51_200) - core::f32::consts::FRAC_PI_2).abs() < 1e-6);
    let turned = ScanMotorConfiguration { counts_per_turn: -204_800.0, ahead_counts: 100, ..published };
    assert!((turned.angle_rad(51_300) + core::f32::consts::FRAC_PI_2).abs() < 1e-6);
    assert_eq!((published.motor_rpm(0.3), turned.motor_rpm(0.3)), (286, -286));
    for broken in [
        ScanMotorConfiguration { counts_per_turn: 0.0, ..published },
        ScanMotorConfiguration { gear: f32::NAN, ..published },
        ScanMotorConfiguration { left_rad: -3.0, ..published },
        ScanMotorConfiguration { speed_radps: 0.0, ..published },
        ScanMotorConfiguration { node: 0, ..published },
    ] {
        assert!(!broken.is_plausible(), "{broken:?}");
    }
    assert!(!published.script().overflowed());
}
