//! Who listens to a run besides its judge: a tape for the emulated board, a recording, the operator's panel.

use std::collections::BTreeMap;
use std::fs::File;
use std::io::BufWriter;
use std::path::Path;
use std::sync::Arc;
use std::time::{Duration, Instant};

use embassy_sync::blocking_mutex::raw::RawMutex;
use floorguard_drivers::can::CanFrame;
use floorguard_runtime::configuration::RobotConfiguration;
use floorguard_runtime::shared::{Shared, StopRecord};
use floorguard_runtime::tape::TapeLine;
use floorguard_types::time::Stamp;

use floorguard_sim::{FaultSpec, FaultTarget};

use super::plan::Plan;
use super::spawn::Stages;
use super::tape::{Tape, encode_route};
use crate::camera::{PictureFolder, SeenDirt};
use crate::cleaner::MissionPlan;
use crate::cleaner::MissionProgress;
use crate::commands::BadInput;
use crate::executor::StopFlag;
use crate::learning::{LearningDesk, LearningSetup};
use crate::panel::{Order, Panel};
use crate::recording::{RecordError, RunInfo, RunRecorder};

/// The fingerprint is written this often, microseconds.
const DIGEST_EVERY_US: u64 = 1_000_000;
/// Points of every fifth sweep are enough for the eye; the raw bytes hold all.
const CLOUDS_EVERY: u32 = 5;
/// Bytes on their way to the disk.
const BUFFER_BYTES: usize = 1 << 20;

/// Name of the text that says whether the raw bytes alone tell the whole run.
pub(super) const REPEATABLE: &str = "repeatable";
/// Name of the text that holds what the robot had learned before.
pub(super) const LEARNED: &str = "learned_before";
/// Name of the text that holds the cleaning mission.
pub(super) const MISSION: &str = "mission";
/// The threads of a robot in real time are not scheduled the same way twice.
const IN_REAL_TIME: &str = "no: it ran in real time";

/// A computer that halts or loses its power does other things with the same bytes.
fn hits_computer(fault: &FaultSpec) -> bool {
    matches!(fault.target, FaultTarget::Computer | FaultTarget::Guard | FaultTarget::Perception)
}

/// A recording on its way into a file.
pub type FileRecorder = RunRecorder<BufWriter<File>>;

/// Everybody who listens; none by default.
#[derive(Default)]
pub struct Witnesses {
    /// A tape for the emulated board.
    pub tape: Tape,
    /// A recording for everybody else.
    pub recording: Option<FileRecorder>,
    /// The simulated camera's pictures.
    pub pictures: Option<PictureFolder>,
    /// A panel: the run then goes in real time, and nobody but its operators resets the robot.
    pub panel: Option<Panel>,
    /// Set by somebody who wants the run to end here and now, in order.
    pub ended: StopFlag,
    /// What the robot learns, for the end of the recording.
    learning: LearningDesk,
    next_digest_us: u64,
    started: Option<Instant>,
}

impl Witnesses {
    /// Starts a recording of a plan.
    ///
    /// # Errors
    /// The file cannot be made.
    pub fn record(&mut self, plan: &Plan, path: &Path) -> anyhow::Result<()> {
        let repeatable = match plan.faults.iter().any(hits_computer) {
            true => "no",
            false if plan.has_camera => "no: the floor camera's pictures are not recorded",
            false => "yes",
        };
        self.record_plan(plan, path, repeatable)
    }

    /// Starts a recording of a plan that is played in real time.
    ///
    /// # Errors
    /// The file cannot be made.
    pub fn record_in_real_time(&mut self, plan: &Plan, path: &Path) -> anyhow::Result<()> {
        self.record_plan(plan, path, IN_REAL_TIME)
    }

    fn record_plan(&mut self, plan: &Plan, path: &Path, repeatable: &str) -> anyhow::Result<()> {
        let texts = [
            ("scenario", plan.name.clone()),
            ("title", plan.scenario.title.clone()),
            ("seed", plan.seed.to_string()),
            ("stages", plan.stages.name().to_owned()),
            (REPEATABLE, repeatable.to_owned()),
        ];
        let mission = plan.mission.as_ref().map(|mission| mission.to_text()).transpose()?;
        let mission = mission.map(|text| (MISSION.to_owned(), text));
        let learned = self.learned_before(plan.learning.as_ref());
        let info = RunInfo {
            robot: &plan.robot,
            robot_toml: &plan.robot_toml,
            imu_baud: super::virtual_world::IMU_BAUD,
            clouds_every: CLOUDS_EVERY,
            texts: texts
                .into_iter()
                .map(|(name, text)| (name.to_owned(), text))
                .chain(mission)
                .chain(learned)
                .collect::<BTreeMap<_, _>>(),
        };
        self.recording = Some(open_recording(path, &info)?);
        Ok(())
    }

    /// Starts a recording of real devices, with the robot's file and the bit rate of its inertial sensor.
    ///
    /// # Errors
    /// The file cannot be made.
    pub fn record_devices(
        &mut self,
        robot: &RobotConfiguration,
        (name, robot_toml, imu_baud): (&str, &str, u32),
        ((mission, learning), path): ((Option<&MissionPlan>, Option<&LearningSetup>), &Path),
    ) -> anyhow::Result<()> {
        let texts = [("title", name), ("stages", Stages::All.name()), (REPEATABLE, IN_REAL_TIME)];
        let mission = mission.map(|mission| mission.to_text()).transpose()?;
        let texts = texts.into_iter().map(|(name, text)| (name.to_owned(), text.to_owned()));
        let texts = texts.chain(mission.map(|text| (MISSION.to_owned(), text)));
        let texts = texts.chain(self.learned_before(learning)).collect();
        let info = RunInfo { robot, robot_toml, imu_baud, clouds_every: CLOUDS_EVERY, texts };
        self.recording = Some(open_recording(path, &info)?);
        Ok(())
    }

    /// What a robot begins with goes into the recording, and at its end what it learned.
    fn learned_before(&mut self, learning: Option<&LearningSetup>) -> Option<(String, String)> {
        let learning = learning?;
        self.learning = learning.desk.clone();
        Some((LEARNED.to_owned(), learning.to_text()))
    }

    /// Somebody listens at all.
    #[must_use]
    pub const fn listen(&self) -> bool {
        self.recording.is_some() || self.panel.is_some()
    }

    /// Why the recording ends before the run.
    #[must_use]
    pub fn failure(&self) -> Option<&RecordError> {
        self.recording.as_ref()?.failure()
    }

    /// Bytes that the tasks get now: moments of delivery and of arrival, microseconds.
    pub fn delivered(&mut self, when: (u64, u64), line: TapeLine, data: &[u8]) {
        self.tape.record(when, line, data);
        if let Some(recording) = &mut self.recording {
            recording.delivered(when, line, data);
        }
        if let (Some(panel), TapeLine::Lidar) = (&mut self.panel, line) {
            panel.lidar_datagram(data, Stamp::from_micros(when.1));
        }
    }

    /// A frame of the robot on the bus.
    pub fn sent(&mut self, frame: &CanFrame, now_us: u64) {
        if let Some(recording) = &mut self.recording {
            recording.sent(frame, now_us);
        }
    }

    /// The cleaning mission has told its progress, about once a second.
    pub fn mission(&mut self, progress: &Arc<MissionProgress>) {
        if let Some(recording) = &mut self.recording {
            recording.mission(progress);
        }
        if let Some(panel) = &mut self.panel {
            panel.mission(progress);
        }
    }

    /// The floor camera's map of dirt.
    pub fn seen_dirt(&mut self, seen: &SeenDirt) {
        if let Some(recording) = &mut self.recording {
            recording.seen_dirt(seen);
        }
    }

    /// A stop that began.
    pub fn stop(&mut self, record: &StopRecord) {
        if let Some(recording) = &mut self.recording {
            recording.stop(record);
        }
        if let Some(panel) = &mut self.panel {
            panel.stop(record);
        }
    }

    /// Shows the robot on the panel and keeps the run in real time; gives what operators have ordered meanwhile.
    pub fn attend<M: RawMutex>(&mut self, shared: &Shared<M>, now_us: u64) -> Vec<Order> {
        let Some(panel) = &mut self.panel else { return Vec::new() };
        let started = *self.started.get_or_insert_with(Instant::now);
        std::thread::sleep(Duration::from_micros(now_us).saturating_sub(started.elapsed()));
        panel.look(shared);
        std::iter::from_fn(|| panel.order()).collect()
    }

    /// What operators have ordered reaches the tasks now.
    pub fn order<M: RawMutex>(&mut self, order: Order, shared: &Shared<M>, now_us: u64) {
        order.apply(shared);
        self.delivered((now_us, now_us), order.line(), &[]);
    }

    /// What the tasks have published meanwhile is written.
    pub fn look<M: RawMutex>(&mut self, shared: &Shared<M>, now_us: u64) {
        if let Some(recording) = &mut self.recording {
            recording.after_tasks(shared, now_us);
        }
    }

    /// The tasks have run, and everything that they put out is in the fingerprint.
    pub fn after_tasks<M: RawMutex>(&mut self, shared: &Shared<M>, (now_us, digest): (u64, u64)) {
        self.look(shared, now_us);
        let Some(recording) = &mut self.recording else { return };
        if now_us >= self.next_digest_us {
            self.next_digest_us = now_us - now_us % DIGEST_EVERY_US + DIGEST_EVERY_US;
            recording.digest(now_us, digest);
        }
    }

    /// The run has ended.
    ///
    /// # Errors
    /// The recording could not be written.
    pub fn finish(&mut self, (duration_us, digest): (u64, u64)) -> Result<(), RecordError> {
        match self.recording.take() {
            Some(mut recording) => {
                recording.learned(self.learning.newest().map(|(report, _)| report.words()));
                recording.finish(duration_us, Some(digest)).map(drop)
            }
            None => Ok(()),
        }
    }

    /// A run in real time has ended; `lost` rows are missing in its recording.
    ///
    /// # Errors
    /// The recording could not be written.
    pub fn finish_in_real_time(&mut self, now_us: u64, lost: u64) -> Result<(), RecordError> {
        let Some(mut recording) = self.recording.take() else { return Ok(()) };
        recording.lost(now_us, lost);
        recording.learned(self.learning.newest().map(|(report, _)| report.words()));
        recording.finish(now_us, None).map(drop)
    }
}

fn open_recording(path: &Path, info: &RunInfo<'_>) -> anyhow::Result<FileRecorder> {
    let unwritable = |error: &dyn std::fmt::Display| {
        BadInput(format!("{}: cannot be written ({error}); give another place", path.display()))
    };
    let file = File::create(path).map_err(|error| unwritable(&error))?;
    let mut recorder = RunRecorder::new(BufWriter::with_capacity(BUFFER_BYTES, file), info)
        .map_err(|error| unwritable(&error))?;
    recorder.delivered((0, 0), TapeLine::Route, &encode_route(info.robot));
    Ok(recorder)
}
