//! Bytes of a lidar that speaks SCIP, and frames of the motor that turns it.
#![allow(clippy::missing_panics_doc)] // That they panic at a wrong answer is what they are for.

use floorguard_drivers::can::CanFrame;
use floorguard_drivers::scan_motor::{ScanMotor, ScanMotorConfiguration, ScanMotorEvent};
use floorguard_drivers::scip::{Device, DeviceConfiguration, DeviceEvent, DevicePhase, SCIP_BEAMS_MAX};
use floorguard_sim::actuated::{LidarModel, Rig, RigEvent, Room};
use floorguard_sim::can::CanFrame as SimulatedFrame;
use floorguard_types::sensing::BeamReturn;
use floorguard_types::time::Stamp;

use super::{corrupt, pick};
use crate::campaign::Random;

/// Frames that one motor sees.
pub const MOTOR_FRAMES: u64 = 20;
/// Portions of bytes that one lidar sees.
const PORTIONS: usize = 8;
/// Steps of the simulated devices, microseconds.
const STEP_US: u64 = 2_000;

fn at(micros: u64) -> Stamp {
    Stamp::from_micros(micros)
}

/// What both devices sent to drivers that asked them, for some seconds.
#[derive(Clone, Default)]
pub struct ScanningCorpus {
    /// Replies of the lidar, each whole.
    pub replies: Vec<Vec<u8>>,
    /// Frames of the motor.
    pub frames: Vec<SimulatedFrame>,
    /// A lidar's driver that gets scans; what it hears next may be anything.
    pub measuring: Option<Device>,
    /// A motor's driver that turns it.
    pub turning: Option<ScanMotor>,
    /// When both stopped.
    pub end_us: u64,
}

impl ScanningCorpus {
    /// Two seconds in a room: until scans come and the motor turns.
    #[must_use]
    pub fn simulated() -> Self {
        let room = Room::named("box").expect("a built-in room");
        let mut rig = Rig::new(room, LidarModel::Urg04lx, (Vec::new(), 3));
        let mut device = Device::new(DeviceConfiguration::URG_04LX);
        let mut motor = ScanMotor::new(ScanMotorConfiguration::PUBLISHED);
        let mut corpus = Self { end_us: 3_000_000, ..Self::default() };
        for now in (1..=corpus.end_us / STEP_US).map(|step| step * STEP_US) {
            let mut heard = Vec::new();
            rig.advance_to(now, &mut |at_us, event| heard.push((at_us, event)));
            for (at_us, event) in heard {
                match event {
                    RigEvent::Lidar(bytes) => {
                        device.push(&bytes, at(at_us), |_| {});
                        corpus.replies.push(bytes);
                    }
                    RigEvent::Frame(frame) => {
                        let known = CanFrame::standard(frame.id as u16, frame.payload());
                        motor.on_frame(&known, at(at_us), &mut |_| {});
                        corpus.frames.push(frame);
                    }
                }
            }
            let (mut bytes, mut frames) = (Vec::new(), Vec::new());
            device.poll(at(now), &mut |command| bytes.extend_from_slice(command));
            motor.poll(at(now), &mut |_| {}, &mut |frame| frames.push(*frame));
            rig.receive(&bytes);
            for frame in frames {
                let id = frame.standard_id().map_or(0, u32::from);
                rig.receive_can(&SimulatedFrame::new(id, frame.payload()));
            }
        }
        (corpus.measuring, corpus.turning) = (Some(device), Some(motor));
        corpus
    }
}

/// A scan is what was asked for: not too many beams, none nearer than the sensor measures or farther than is believed, stamped
/// between the beginning of time and now.
fn check_scan(event: &DeviceEvent<'_>, now: Stamp) -> u64 {
    let DeviceEvent::Scan(scan) = event else { return 0 };
    assert!(scan.beams.len() <= SCIP_BEAMS_MAX && scan.first_beam <= now, "{:?}", scan.first_beam);
    assert!(scan.step_rad > 0.0 && scan.first_angle_rad.is_finite() && scan.beam_period_us >= 0.0);
    let is_possible =
        |beam: &BeamReturn| !matches!(beam, BeamReturn::Hit(range_mm) if *range_mm < 20 || *range_mm > 4_000);
    assert!(scan.beams.iter().all(is_possible), "an error code or a range beyond belief as a hit");
    1
}

/// Bytes of the lidar in portions, with time between them. Afterwards the driver asks again and understands a whole
/// conversation.
pub fn scip(corpus: &ScanningCorpus, bytes: &[u8], afterwards: bool) -> u64 {
    let mut device = corpus.measuring.clone().unwrap_or(Device::new(DeviceConfiguration::URG_04LX));
    let (mut scans, mut now) = (0, corpus.end_us);
    for part in bytes.chunks(bytes.len().div_ceil(PORTIONS).max(1)) {
        now += 1_000;
        device.push(part, at(now), |event| scans += check_scan(&event, at(now)));
        device.poll(at(now), &mut |command| assert!(command.ends_with(b"\n")));
    }
    if afterwards {
        assert!(finds_back(device, now), "it did not find back into step");
    }
    scans
}

/// A right sensor at the other end: within ten seconds it is asked for scans, and they are understood.
fn finds_back(mut device: Device, begin_us: u64) -> bool {
    let mut sensor = floorguard_sim::actuated::ScanLidar::new(LidarModel::Urg04lx, 5);
    let (mut sent, mut scans) = (Vec::new(), 0);
    for step in 1..=500_u64 {
        let since_us = step * 20_000;
        let now = at(begin_us + since_us);
        sensor.receive(&std::mem::take(&mut sent), since_us);
        for (_, reply) in sensor.measure(since_us, |_, _| Some(1.0)) {
            device.push(&reply, now, |event| scans += check_scan(&event, now));
        }
        device.poll(now, &mut |command| sent.extend_from_slice(command));
        if scans > 2 && device.phase() == DevicePhase::Measuring {
            return true;
        }
    }
    false
}

/// Corrupted frames of the motor and time between them: no angle of the future or that is not finite, and commands within the
/// limits.
pub fn scan_motor(corpus: &ScanningCorpus, random: &mut Random) -> u64 {
    let unknown = ScanMotor::new(ScanMotorConfiguration::PUBLISHED);
    let mut motor = if random.seldom(4) { unknown } else { corpus.turning.clone().unwrap_or(unknown) };
    let (mut now, mut angles) = (corpus.end_us, 0);
    for _ in 0..MOTOR_FRAMES {
        let frame = pick(&corpus.frames, random);
        let mut payload = frame.data[..usize::from(frame.len.min(8))].to_vec();
        corrupt(&mut payload, &[0xFF; 8], 8, random);
        let id = if random.seldom(4) { random.below(0x800) as u16 } else { frame.id as u16 & 0x7FF };
        let begun = at(now);
        let mut event = |event: ScanMotorEvent| {
            if let ScanMotorEvent::Angle { stamp, angle_rad, commanded_radps } = event {
                angles += 1;
                assert!(stamp <= begun && angle_rad.is_finite() && commanded_radps.abs() <= 0.3, "{event:?}");
            }
        };
        motor.on_frame(&CanFrame::standard(id, &payload), begun, &mut event);
        now += random.below(9_000);
        motor.poll(at(now), &mut event, &mut |frame| assert!(frame.payload().len() <= 8));
        assert!(motor.commanded_radps().abs() <= 0.3);
    }
    angles
}
