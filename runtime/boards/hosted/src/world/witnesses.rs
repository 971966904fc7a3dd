//! Who listens to a run besides its judge: a tape for the emulated board, a recording, the operator's panel.

use std::collections::BTreeMap;
use std::fs::File;
use std::io::BufWriter;
use std::path::Path;
use std::time::{Duration, Instant};

use embassy_sync::blocking_mutex::raw::RawMutex;
use floorguard_core::time::Stamp;
use floorguard_drivers::can::CanFrame;
use floorguard_runtime::shared::{Shared, StopRecord};
use floorguard_runtime::tape::TapeLine;

use floorguard_sim::{FaultSpec, FaultTarget};

use super::plan::Plan;
use super::tape::{Tape, encode_route};
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
    /// A panel: the run then goes in real time, and nobody but its operators resets the robot.
    pub panel: Option<Panel>,
    next_digest_us: u64,
    started: Option<Instant>,
}

impl Witnesses {
    /// Starts a recording of a plan.
    ///
    /// # Errors
    /// The file cannot be made.
    pub fn record(&mut self, plan: &Plan, path: &Path) -> anyhow::Result<()> {
        let unwritable = |error: &dyn std::fmt::Display| {
            anyhow::anyhow!("{}: cannot be written ({error}); give another place", path.display())
        };
        let file = File::create(path).map_err(|error| unwritable(&error))?;
        let texts = [
            ("scenario", plan.name.clone()),
            ("title", plan.scenario.title.clone()),
            ("seed", plan.seed.to_string()),
            ("stages", plan.stages.name().to_owned()),
            (REPEATABLE, if plan.faults.iter().any(hits_computer) { "no" } else { "yes" }.to_owned()),
        ];
        let info = RunInfo {
            robot: &plan.robot,
            robot_toml: crate::configuration::EXAMPLE,
            imu_baud: super::virtual_world::IMU_BAUD,
            clouds_every: CLOUDS_EVERY,
            texts: texts.into_iter().map(|(name, text)| (name.to_owned(), text)).collect::<BTreeMap<_, _>>(),
        };
        let mut recorder = RunRecorder::new(BufWriter::with_capacity(BUFFER_BYTES, file), &info)
            .map_err(|error| unwritable(&error))?;
        recorder.delivered((0, 0), TapeLine::Route, &encode_route(&plan.robot));
        self.recording = Some(recorder);
        Ok(())
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

    /// The tasks have run, and everything that they put out is in the fingerprint.
    pub fn after_tasks<M: RawMutex>(&mut self, shared: &Shared<M>, (now_us, digest): (u64, u64)) {
        let Some(recording) = &mut self.recording else { return };
        recording.after_tasks(shared, now_us);
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
            Some(recording) => recording.finish(duration_us, digest).map(drop),
            None => Ok(()),
        }
    }
}
