//! The drivers of lidar and motor, and what they give to the window.

use floorguard_drivers::can::CanFrame;
use floorguard_drivers::scan_motor::{ScanMotor, ScanMotorConfiguration, ScanMotorEvent};
use floorguard_drivers::scip::{Device, DeviceConfiguration, DeviceEvent, MeasuredScan};
use floorguard_mapping::sliding_window::{ColumnScan, MotorSample, MotorTrack};
use floorguard_types::geometry::Pose2;
use floorguard_types::time::Stamp;

use super::window_map::WindowMap;

/// Poses that are kept: a second and a half.
const POSES: usize = 150;
/// Different faults that are kept.
const FAULTS_MAX: usize = 16;
/// Scans that wait for their angles: more, and the motor is silent.
const WAITING_MAX: usize = 64;
/// A scan waits so long for the angle after its last beam, microseconds.
const WAIT_US: u64 = 40_000;

/// A lidar on a motor.
pub struct Session {
    device: Device,
    motor: ScanMotor,
    track: MotorTrack,
    waiting: Vec<MeasuredScan>,
    poses: Vec<(Stamp, Pose2)>,
    /// The lidar's parameters, once they have come.
    pub lidar: Option<String>,
    /// What motor and lidar reported as wrong: the first of them, each once.
    pub faults: Vec<String>,
}

impl Session {
    /// Nothing was asked for yet.
    #[must_use]
    pub fn new(lidar: DeviceConfiguration, motor: ScanMotorConfiguration) -> Self {
        Self {
            device: Device::new(lidar),
            motor: ScanMotor::new(motor),
            track: MotorTrack::new(),
            waiting: Vec::new(),
            poses: Vec::new(),
            lidar: None,
            faults: Vec::new(),
        }
    }

    /// Half of the best round trip of the lidar's clock, microseconds.
    #[must_use]
    pub fn clock_uncertainty_us(&self) -> Option<u64> {
        self.device.clock_uncertainty_us()
    }

    /// Where the robot stood at a time; one that is known already is left out.
    pub fn stand_at(&mut self, stamp: Stamp, pose: Pose2) {
        if self.poses.last().is_some_and(|(newest, _)| *newest >= stamp) {
            return;
        }
        if self.poses.len() >= POSES {
            self.poses.remove(0);
        }
        self.poses.push((stamp, pose));
    }

    /// Where the robot stood nearest to a time.
    #[must_use]
    pub fn pose_at(&self, stamp: Stamp) -> Option<Pose2> {
        nearest(&self.poses, stamp)
    }

    /// What is due is sent.
    pub fn poll(&mut self, now: Stamp, (bytes, frames): (&mut Vec<u8>, &mut Vec<CanFrame>)) {
        if self.device.poll(now, &mut |command| bytes.extend_from_slice(command)) {
            note(&mut self.faults, "the lidar does not answer".to_owned());
        }
        let faults = &mut self.faults;
        let mut event = |event| {
            if let ScanMotorEvent::Fault(fault) = event {
                note(faults, format!("the motor: {fault:?}"));
            }
        };
        self.motor.poll(now, &mut event, &mut |frame| frames.push(*frame));
    }

    /// Bytes of the lidar.
    pub fn hear_lidar(&mut self, bytes: &[u8], now: Stamp, map: &mut WindowMap) {
        let Self { device, waiting, lidar, faults, .. } = self;
        device.push(bytes, now, |event| match event {
            DeviceEvent::Scan(scan) if waiting.len() < WAITING_MAX => waiting.push(scan.clone()),
            DeviceEvent::Scan(_) => map.taken.refuse("angle_missing", "no angle of the motor".to_owned()),
            DeviceEvent::Parameters(parameters) => *lidar = Some(format!("{parameters:?}")),
            DeviceEvent::Refused(refused) => {
                map.taken.refuse("damaged", format!("a reply of the lidar is damaged: {refused:?}"));
            }
            DeviceEvent::Fault(status) => note(faults, format!("the lidar: {status:?}")),
            DeviceEvent::Unsuitable(parameters) => {
                note(faults, format!("the lidar cannot measure what is asked for: {parameters:?}"));
            }
            DeviceEvent::Silent => {}
        });
    }

    /// A frame of the bus.
    pub fn hear_bus(&mut self, frame: &CanFrame, now: Stamp, map: &mut WindowMap) {
        let Self { motor, track, faults, .. } = self;
        motor.on_frame(frame, now, &mut |event| match event {
            ScanMotorEvent::Angle { stamp, angle_rad, commanded_radps } => {
                if let Err(error) = track.push(MotorSample { stamp, angle_rad, commanded_radps }) {
                    map.taken.refuse("angle", error.to_string());
                }
            }
            ScanMotorEvent::SweepEnd => map.end_sweep(),
            ScanMotorEvent::Fault(fault) => note(faults, format!("the motor: {fault:?}")),
        });
    }

    /// Enters the scans whose angles are there, or cannot come any more.
    pub fn enter(&mut self, now: Stamp, map: &mut WindowMap) {
        let ready = |scan: &MeasuredScan| {
            let end = last_beam(scan);
            self.track.angle_at(end).is_ok() || end.plus_micros(WAIT_US) < now
        };
        let count = self.waiting.iter().take_while(|scan| ready(scan)).count();
        for scan in self.waiting.drain(..count) {
            let middle = scan.first_beam.plus_micros(scan.first_beam.past_us(last_beam(&scan)) / 2);
            let pose = nearest(&self.poses, middle);
            let column = ColumnScan {
                first_beam: scan.first_beam,
                beam_period_us: scan.beam_period_us,
                first_elevation_rad: scan.first_angle_rad,
                step_rad: scan.step_rad,
                beams: &scan.beams,
            };
            map.insert(&column, &self.track, pose.unwrap_or_default());
        }
    }
}

fn nearest(poses: &[(Stamp, Pose2)], stamp: Stamp) -> Option<Pose2> {
    let nearest = poses.iter().min_by_key(|(at, _)| at.past_us(stamp).max(stamp.past_us(*at)));
    nearest.map(|(_, pose)| *pose)
}

/// A robot runs for months: each fault once, and no more than these.
fn note(faults: &mut Vec<String>, what: String) {
    if faults.len() < FAULTS_MAX && !faults.contains(&what) {
        faults.push(what);
    }
}

fn last_beam(scan: &MeasuredScan) -> Stamp {
    scan.first_beam.plus_micros((scan.beams.len() as f32 * scan.beam_period_us) as u64)
}
