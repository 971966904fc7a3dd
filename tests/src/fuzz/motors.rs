//! Motor controllers: corrupted frames and lines of simulated ones, orders and time between them.

use floorguard_drivers::can::CanFrame;
use floorguard_drivers::motor_drives::{MotorDrives, MotorDrivesConfiguration, MotorProtocol};
use floorguard_drivers::three_wheel_base::StopKind;
use floorguard_drivers::wheel_drives::{SideTargets, WheelCommand};
use floorguard_sim::CanFrame as SimulatedFrame;
use floorguard_sim::motors::{MotorBank, MotorKind, MotorParameters};
use floorguard_types::time::Stamp;

use crate::campaign::Random;

use super::corrupt::{corrupt, pick};

/// Frames that one base sees.
pub const MOTOR_FRAMES: u64 = 24;
/// Frames that the runtime takes of a poll.
const SENT_MAX: usize = 16;

/// A conversation that goes before takes so long, milliseconds.
const MET_MS: u64 = 300;

const KINDS: [(MotorProtocol, MotorKind); 5] = [
    (MotorProtocol::Odrive, MotorKind::Odrive),
    (MotorProtocol::Vesc, MotorKind::Vesc),
    (MotorProtocol::Roboteq, MotorKind::Roboteq),
    (MotorProtocol::RoboteqCan, MotorKind::RoboteqCan),
    (MotorProtocol::WheelLine, MotorKind::WheelLine),
];

/// What simulated controllers of a kind send in their first third of a second while they are asked, and who has asked them.
#[derive(Clone, Debug)]
pub struct MotorTalk {
    frames: Vec<SimulatedFrame>,
    base: MotorDrives,
}

/// Such talks of each kind.
pub type MotorTalks = [MotorTalk; 5];

/// Talks to simulated controllers of each kind.
#[must_use]
pub fn motor_talks() -> MotorTalks {
    KINDS.map(|(protocol, kind)| {
        let mut bank = MotorBank::new(MotorParameters {
            kind,
            wheels: 2,
            nodes: [1, 2, 0, 0],
            metres_per_turn: [0.5; 4],
            counts_per_turn: 2_000.0,
            pole_pairs: 7.0,
            watchdog_ms: 200,
        });
        let mut base = MotorDrives::new(of(protocol));
        let mut frames = Vec::new();
        for millis in 1..=MET_MS {
            let mut out = Vec::new();
            bank.tick((millis * 1_000, 1.0e-3), ([0.2, 0.3, 0.0, 0.0], [0.1; 4]), &mut out);
            base.poll(Stamp::from_micros(millis * 1_000), &mut |_| {}, &mut |frame| {
                let sent = match frame.extended_id() {
                    Some(id) => SimulatedFrame::extended(id, frame.payload()),
                    None => SimulatedFrame::new(u32::from(frame.standard_id().unwrap_or(0)), frame.payload()),
                };
                bank.receive(&sent, millis * 1_000, &mut out);
            });
            for frame in &out {
                base.on_frame(
                    &heard(frame, frame.payload()),
                    Stamp::from_micros(millis * 1_000),
                    &mut |_| {},
                );
            }
            frames.extend(out);
        }
        assert!(base.is_complete(), "{protocol:?}: not met");
        MotorTalk { frames, base }
    })
}

fn heard(frame: &SimulatedFrame, payload: &[u8]) -> CanFrame {
    if frame.extended {
        CanFrame::extended(frame.id, payload).expect("29 bits")
    } else {
        CanFrame::standard(frame.id as u16, payload)
    }
}

fn of(protocol: MotorProtocol) -> MotorDrivesConfiguration {
    MotorDrivesConfiguration { protocol, ..MotorDrivesConfiguration::default() }
}

/// Corrupted frames, orders and time: bounded answers, and a stop without torque moves nothing.
pub fn motors(talks: &MotorTalks, random: &mut Random) -> u64 {
    let kind = random.below(KINDS.len() as u64) as usize;
    let protocol = KINDS[kind].0;
    // It meets them for the first time, or knows them already.
    let mut base = if random.seldom(3) { MotorDrives::new(of(protocol)) } else { talks[kind].base.clone() };
    let (mut now, mut reported) = (MET_MS * 1_000, 0);
    for _ in 0..MOTOR_FRAMES {
        now += random.below(30_000);
        let frame = pick(&talks[kind].frames, random);
        let mut payload = frame.data[..usize::from(frame.len.min(8))].to_vec();
        if !random.seldom(3) {
            corrupt(&mut payload, &[0xFF; 8], 8, random);
        }
        let heard = heard(frame, &payload[..payload.len().min(8)]);
        base.on_frame(&heard, Stamp::from_micros(now), &mut |_| reported += 1);
        match random.below(8) {
            0 => base.command(WheelCommand::Move(SideTargets { left_mps: 0.4, right_mps: f32::NAN })),
            1 => base.command(WheelCommand::Move(SideTargets { left_mps: 0.4, right_mps: 0.5 })),
            2 => base.command(WheelCommand::Stop(StopKind::TorqueOff)),
            3 => base.reset_faults(),
            _ => {}
        }
        let (mut sent, mut fastest) = (0, 0.0_f32);
        base.poll(Stamp::from_micros(now), &mut |_| {}, &mut |frame| {
            sent += 1;
            fastest = fastest.max(asked_speed(protocol, frame).abs());
        });
        let is_off = base.commanded() == WheelCommand::Stop(StopKind::TorqueOff);
        let may_drive = base.watchdog().allows() && !is_off;
        assert!(fastest.is_finite() && (may_drive || fastest == 0.0), "{protocol:?} {fastest}");
        assert!(sent <= SENT_MAX, "{sent}");
        assert!(base.is_whole());
    }
    reported
}

/// The speed that a frame asks for, in the controller's unit; 0 for all others.
fn asked_speed(protocol: MotorProtocol, frame: &CanFrame) -> f32 {
    let Some(bytes) = frame.payload().first_chunk::<4>() else { return 0.0 };
    match (protocol, frame.standard_id(), frame.extended_id()) {
        (MotorProtocol::Odrive, Some(id), _) if id & 0x1F == 0x0D => f32::from_le_bytes(*bytes),
        (MotorProtocol::RoboteqCan, Some(id), _) if id & 0x780 == 0x200 => i32::from_le_bytes(*bytes) as f32,
        (MotorProtocol::Vesc, _, Some(id)) if id >> 8 == 3 => i32::from_be_bytes(*bytes) as f32,
        _ => 0.0,
    }
}
