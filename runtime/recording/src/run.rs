//! The recording of a run: every byte that reaches the robot, and everything that it makes of them.
//!
//! A failing disk must not stop a robot: the first failure is kept, nothing is written to the file any more, and
//! [`RunRecorder::finish`] reports it. Listeners go on.

#[cfg(test)]
mod inertial_tests;
mod maps;

use std::collections::BTreeMap;
use std::io::{Seek, Write};
use std::sync::Arc;
use std::time::{SystemTime, UNIX_EPOCH};

use embassy_sync::blocking_mutex::raw::RawMutex;
use floorguard_drivers::can::CanFrame;
use floorguard_drivers::inertial::{AnyInertialSensor, InertialEvent, InertialSensor};
use floorguard_guard::{Cause, GuardState, ResetReport};
use floorguard_runtime::configuration::RobotConfiguration;
use floorguard_runtime::shared::{RobotStatus, Shared, StopRecord};
use floorguard_runtime::tape::{TapeLine, frame_identifier};
use floorguard_types::time::Stamp;

use floorguard_robot::cleaner::{MissionPhase, MissionProgress};

use super::describe;
use super::detection_messages;
use super::lidar_view::LidarView;
use super::listener::MessageListener;
use super::navigation::SeenDrive;
use super::raw::RawStream;
use super::recorder::{RecordError, Recorder};
use super::scan_map::ScanMap;
use super::schemas;
use super::times::Times;
use super::topics::{self, MotionRow};

/// Name of the texts about the run.
pub const RUN_METADATA: &str = "floorguard";
/// Name of the texts about its end.
pub const END_METADATA: &str = "floorguard end";
/// Name of the text at the end that says what the robot learned.
pub const LEARNED: &str = "learned";
/// Poses are recorded this often at most, microseconds.
const MOTION_EVERY_US: u64 = 20_000;
/// Health, counters, frames of mountings and the fingerprint: once a second, microseconds.
const SLOW_EVERY_US: u64 = 1_000_000;

/// What is known before the run begins.
#[derive(Clone, Debug)]
pub struct RunInfo<'a> {
    /// The robot.
    pub robot: &'a RobotConfiguration,
    /// Its configuration as text, complete.
    pub robot_toml: &'a str,
    /// Bit rate of the inertial sensor's line.
    pub imu_baud: u32,
    /// Every so many sweeps the points are written too; 0: never. The raw bytes hold every sweep.
    pub clouds_every: u32,
    /// Anything else worth knowing: scenario, seed, title.
    pub texts: BTreeMap<String, String>,
}

/// A run being recorded.
pub struct RunRecorder<W: Write + Seek> {
    recorder: Recorder<W>,
    lidar: LidarView,
    imu: AnyInertialSensor,
    imu_samples: Vec<floorguard_types::sensing::ImuSample>,
    fields: Vec<Vec<super::Marker>>,
    mountings: Vec<(&'static str, floorguard_types::geometry::Transform3)>,
    map: ScanMap,
    mission: Option<Arc<MissionProgress>>,
    drive: SeenDrive,
    seen: Seen,
    failed: Option<RecordError>,
    learned: Option<String>,
    /// The run is in real time: what the clock on the wall shows is written, too.
    has_wall_clock: bool,
}

/// What has been written already.
#[derive(Default)]
struct Seen {
    people: u32,
    status: u32,
    scan: u32,
    motion_us: Option<u64>,
    /// The newest moment of the recording.
    now_us: u64,
    slow_us: u64,
    map_scan_us: u64,
    map_us: u64,
    mission_us: Option<u64>,
    phase: Option<MissionPhase>,
    field_set: Option<usize>,
    state: Option<(GuardState, bool, Option<Cause>)>,
    resets: ResetReport,
}

impl<W: Write + Seek> RunRecorder<W> {
    /// Starts the recording of a run.
    ///
    /// # Errors
    /// When the file cannot be written.
    pub fn new(sink: W, info: &RunInfo<'_>) -> Result<Self, RecordError> {
        Self::over(Recorder::new(sink)?, info)
    }

    /// The same over a recorder that is packed, or that has no file but listeners.
    ///
    /// # Errors
    /// When the file cannot be written.
    pub fn over(mut recorder: Recorder<W>, info: &RunInfo<'_>) -> Result<Self, RecordError> {
        let mut texts = info.texts.clone();
        texts.insert("version".to_owned(), env!("CARGO_PKG_VERSION").to_owned());
        texts.insert("robot.toml".to_owned(), info.robot_toml.to_owned());
        texts.insert("imu_baud".to_owned(), info.imu_baud.to_string());
        recorder.metadata(RUN_METADATA, texts)?;
        let robot = info.robot;
        let mut mountings = vec![
            ("lidar", robot.lidar.mounting.transform()),
            ("scanner", robot.scanner.mounting.transform()),
        ];
        mountings.extend(robot.imu.map(|imu| ("imu", imu.mounting.transform())));
        Ok(Self {
            recorder,
            lidar: LidarView::new(robot.lidar_decoder(), robot.ring_angles(), info.clouds_every),
            imu: robot.imu.unwrap_or_default().model.driver(info.imu_baud),
            imu_samples: Vec::new(),
            fields: robot.fields.iter().map(describe::fields).collect(),
            mountings,
            map: ScanMap::default(),
            mission: None,
            drive: SeenDrive::default(),
            seen: Seen::default(),
            failed: None,
            learned: None,
            has_wall_clock: false,
        })
    }

    /// Every message from now on reaches this listener, too.
    pub fn listen(&mut self, listener: Box<dyn MessageListener>) {
        self.recorder.listen(listener);
    }

    /// The run is in real time: once a second the clock on the wall is written beside the robot's.
    pub fn write_wall_clock(&mut self) {
        self.has_wall_clock = true;
    }

    /// Why nothing is written any more.
    #[must_use]
    pub const fn failure(&self) -> Option<&RecordError> {
        self.failed.as_ref()
    }

    pub(super) fn write(&mut self, write: impl FnOnce(&mut Recorder<W>) -> Result<(), RecordError>) {
        if let Err(error) = write(&mut self.recorder) {
            // Listeners go on without the file.
            self.recorder.abandon_file();
            self.failed.get_or_insert(error);
        }
    }

    /// Bytes that the tasks get now: moments of delivery and of arrival, microseconds.
    pub fn delivered(&mut self, (deliver_us, arrival_us): (u64, u64), line: TapeLine, data: &[u8]) {
        let (logged, published) = (Stamp::from_micros(deliver_us), Stamp::from_micros(arrival_us));
        let times = Times { logged, published };
        let number = line.number().to_le_bytes();
        let data = if RawStream::of_line(line) == RawStream::Operator { &number[..1] } else { data };
        self.write(|out| out.raw(RawStream::of_line(line), times, data));
        match line {
            TapeLine::Lidar => {
                if let Some((stamp, points)) = self.lidar.push(data, published) {
                    let times = Times { logged, published: stamp };
                    self.write(|out| out.points(times, (stamp, "lidar"), &points));
                }
            }
            TapeLine::Imu => {
                let samples = &mut self.imu_samples;
                self.imu.take(data, logged, &mut |event| {
                    if let InertialEvent::Sample(sample) = event {
                        samples.push(sample);
                    }
                });
                // A device that was refused is asked again after a while and then believed; here nobody hears the question.
                self.imu.request(logged, &mut |_| {});
                for sample in std::mem::take(&mut self.imu_samples) {
                    self.write(|out| out.imu(logged, &sample));
                }
            }
            _ => {}
        }
    }

    /// A frame of the robot on the bus.
    pub fn sent(&mut self, frame: &CanFrame, now_us: u64) {
        let id = frame_identifier(frame).unwrap_or_default().to_le_bytes();
        let bytes: Vec<u8> = id.iter().chain(frame.payload()).copied().collect();
        self.write(|out| out.raw(RawStream::CanSent, Stamp::from_micros(now_us), &bytes));
    }

    /// A stop that began.
    pub fn stop(&mut self, record: &StopRecord) {
        self.write(|out| out.diagnostics(topics::STOPS, record.stamp, &[describe::stop(record)]));
    }

    /// The tasks have run: what they published is written.
    pub fn after_tasks<M: RawMutex>(&mut self, shared: &Shared<M>, now_us: u64) {
        self.seen.now_us = now_us;
        let now = Stamp::from_micros(now_us);
        let (people, status, scan) =
            (shared.people.published(), shared.status.published(), shared.scan.published());
        if self.seen.scan != scan
            && let Some(scan) = shared.scan.get()
        {
            self.write(|out| out.scan(now, &scan));
            self.map(shared, &scan, now_us);
        }
        if self.seen.motion_us.is_none_or(|last_us| now_us >= last_us + MOTION_EVERY_US)
            && let Some(pose) = shared.pose.get()
        {
            self.seen.motion_us = Some(now_us);
            let [x, y, heading] = shared.move_by(|motion| motion.filter().pose_variances());
            let row = MotionRow {
                stamp: pose.stamp,
                pose_in_odom: pose.pose_in_odometry,
                twist: pose.twist,
                covariance: [[x, 0.0, 0.0], [0.0, y, 0.0], [0.0, 0.0, heading]],
            };
            self.write(|out| out.motion(now, &row));
        }
        if self.seen.people != people
            && let Some(report) = shared.people.get()
        {
            self.write(|out| out.markers(topics::PEOPLE, (now, "odom"), &describe::people(&report)));
            let found = detection_messages::detections(now, &report);
            self.write(|out| out.message(topics::DETECTIONS, &schemas::DETECTIONS, now, &found));
        }
        if self.seen.status != status
            && let Some(status) = shared.status.get()
        {
            self.on_status(&status, now);
        }
        if now_us >= self.seen.slow_us {
            self.seen.slow_us = now_us - now_us % SLOW_EVERY_US + SLOW_EVERY_US;
            self.slow(shared, now);
        }
        (self.seen.people, self.seen.status, self.seen.scan) = (people, status, scan);
    }

    fn on_status(&mut self, status: &RobotStatus, now: Stamp) {
        let decision = &status.decision;
        self.write(|out| out.permitted(now, decision.permitted, decision.speed_limit_mps));
        let holding = decision.holding_cause.filter(|record| record.action.stops());
        let state = (decision.state, decision.action.stops(), holding.map(|record| record.cause));
        if self.seen.state != Some(state) {
            self.seen.state = Some(state);
            self.write(|out| out.diagnostics(topics::DIAGNOSTICS, now, &[describe::decision(decision)]));
        }
        if self.seen.resets != status.resets {
            self.seen.resets = status.resets;
            self.write(|out| out.diagnostics(topics::DIAGNOSTICS, now, &[describe::reset(&status.resets)]));
        }
        if self.seen.field_set != Some(decision.field_set) {
            self.seen.field_set = Some(decision.field_set);
            let drawn = self.fields.get(decision.field_set).cloned().unwrap_or_default();
            self.write(|out| out.markers(topics::FIELDS, (now, "base_link"), &drawn));
        }
    }

    fn slow<M: RawMutex>(&mut self, shared: &Shared<M>, now: Stamp) {
        for (name, transform) in self.mountings.clone() {
            self.write(|out| out.mounting(now, name, &transform));
        }
        let mut list = Vec::new();
        if let Some(status) = shared.status.get() {
            list.push(describe::decision(&status.decision));
            list.extend(status.sources.iter().filter(|report| report.fitted).map(describe::source));
        }
        list.extend(shared.people.get().map(|report| describe::perception(&report)));
        list.push(describe::links(&shared.links()));
        self.write(|out| out.diagnostics(topics::DIAGNOSTICS, now, &list));
        if self.has_wall_clock
            && let Ok(since_1970) = SystemTime::now().duration_since(UNIX_EPOCH)
        {
            let unix_us = u64::try_from(since_1970.as_micros()).unwrap_or(u64::MAX);
            let both = detection_messages::wall_clock(now, unix_us);
            self.write(|out| out.message(topics::WALL_CLOCK, &schemas::TIME_REFERENCE, now, &both));
        }
        self.write(Recorder::flush);
    }

    /// The fingerprint of the outputs up to this moment.
    pub fn digest(&mut self, now_us: u64, digest: u64) {
        self.write(|out| out.digest(Stamp::from_micros(now_us), digest));
    }

    /// Entries of the order of a run in real time.
    pub fn order(&mut self, now_us: u64, entries: &[u8]) {
        self.write(|out| out.order(Stamp::from_micros(now_us), entries));
    }

    /// Rows of the lines that the recorder has missed, if any.
    pub fn lost(&mut self, now_us: u64, rows: u64) {
        if rows > 0 {
            let list = [describe::lost(rows)];
            self.write(|out| out.diagnostics(topics::DIAGNOSTICS, Stamp::from_micros(now_us), &list));
        }
    }

    /// What the robot learned, in words, for the end.
    pub fn learned(&mut self, words: Option<String>) {
        self.learned = words;
    }

    /// The run has ended: how long it was, and the fingerprint of all outputs, if it has one.
    ///
    /// # Errors
    /// The first failed write.
    pub fn finish(mut self, duration_us: u64, digest: Option<u64>) -> Result<Option<W>, RecordError> {
        self.write_map(duration_us);
        if let Some(progress) = self.mission.take() {
            self.write_mission(&progress, duration_us);
        }
        let mut texts = BTreeMap::from([("duration_us".to_owned(), duration_us.to_string())]);
        texts.extend(self.learned.take().map(|words| (LEARNED.to_owned(), words)));
        texts.extend(digest.map(|digest| ("digest".to_owned(), format!("{digest:016x}"))));
        self.write(|out| out.metadata(END_METADATA, texts));
        match self.failed {
            Some(error) => Err(error),
            None => self.recorder.close(),
        }
    }
}
