//! Who listens to a run besides its judge: a tape for the emulated board, a recording, the operator's panel.

use std::collections::BTreeMap;
use std::path::Path;
use std::sync::Arc;
use std::time::{Duration, Instant};

use embassy_sync::blocking_mutex::raw::RawMutex;
use floorguard_drivers::can::CanFrame;
use floorguard_runtime::shared::{Shared, StopRecord};
use floorguard_runtime::tape::TapeLine;
use floorguard_types::geometry::{Pose2, Twist2};
use floorguard_types::time::Stamp;

use super::recorded_run::{FileRecorder, IN_REAL_TIME, RECORDED_AT, RecordedRun, open_recording};
use super::run_link::{LinkMoment, RunLink};
use super::tape::Tape;
use crate::panel::{Panel, PanelOrder};
use floorguard_host::executor::StopFlag;
use floorguard_recording::order::{ORDER, ORDER_VERSION, OrderLog};
use floorguard_recording::replay::{LEARNED, MISSION, NAVIGATION, REPEATABLE};
use floorguard_recording::truth::TrueSolid;
use floorguard_recording::{Compression, MessageListener, RecordError, Recorder, RunInfo, RunRecorder};
use floorguard_robot::assembly::{Stages, TapRow};
use floorguard_robot::camera::{ColourPicture, PictureFolder, SeenDirt};
use floorguard_robot::cleaner::{MissionOrder, MissionOrders, MissionPlan, MissionProgress, MissionSetup};
use floorguard_robot::environment::Calendar;
use floorguard_robot::learning::{LearningSetup, LearningSlot};
use floorguard_robot::navigator::{NavigationPlan, NavigationProgress};

/// The fingerprint is written this often, microseconds.
const DIGEST_EVERY_US: u64 = 1_000_000;
/// Points of every fifth sweep are enough for display; the raw bytes hold all.
const CLOUDS_EVERY: u32 = 5;

/// All sinks of a run; none by default.
#[derive(Default)]
pub struct RunSinks {
    /// A tape for the emulated board.
    pub tape: Tape,
    /// A recording for everybody else, into a file, to listeners, or both.
    pub recording: Option<FileRecorder>,
    /// How a recording's file is packed.
    pub compression: Compression,
    /// Programs outside that are shown the robot and give orders, such as a fleet's master.
    pub links: Vec<Box<dyn RunLink>>,
    /// Somebody watches live: a run in virtual time then goes no faster than the clock on the wall.
    is_watched: bool,
    drive: Option<Arc<NavigationProgress>>,
    /// The simulated camera's pictures.
    pub pictures: Option<PictureFolder>,
    /// A panel: the run then goes in real time, and nobody but its operators resets the robot.
    pub panel: Option<Panel>,
    /// Where orders to the mission go.
    pub missions: Option<MissionOrders>,
    /// The first order to the mission: the areas that are kept.
    pub first_order: Option<MissionOrder>,
    /// Set by somebody who wants the run to end here and now, in order.
    pub ended: StopFlag,
    /// What the robot learns, for the end of the recording.
    learning: LearningSlot,
    order: OrderLog,
    next_digest_us: u64,
    started: Option<Instant>,
}

impl RunSinks {
    /// Starts a recording with these texts, by name.
    ///
    /// # Errors
    /// The file cannot be made.
    pub fn record_run(
        &mut self,
        run: &RecordedRun<'_>,
        texts: &[(&str, &str)],
        path: &Path,
    ) -> anyhow::Result<()> {
        let RecordedRun { robot, robot_toml, imu_baud, .. } = *run;
        let mission = run.mission.map(MissionPlan::to_text).transpose()?;
        let navigation = run.navigation.map(NavigationPlan::to_text).transpose()?;
        let in_real_time = texts.contains(&(REPEATABLE, IN_REAL_TIME));
        let order = in_real_time.then_some((ORDER, ORDER_VERSION));
        let texts = texts.iter().chain(&order);
        let texts = texts.map(|(name, text)| ((*name).to_owned(), (*text).to_owned()));
        let recorded_at = in_real_time.then(|| Calendar::of_this_computer().iso(Calendar::now()));
        let texts = texts.chain(recorded_at.map(|moment| (RECORDED_AT.to_owned(), moment)));
        let texts = texts.chain(mission.map(|text| (MISSION.to_owned(), text)));
        let texts = texts.chain(navigation.map(|text| (NAVIGATION.to_owned(), text)));
        let texts = texts.chain(self.learned_before(run.learning)).collect::<BTreeMap<_, _>>();
        let info = RunInfo { robot, robot_toml, imu_baud, clouds_every: CLOUDS_EVERY, texts };
        let mut recording = open_recording((path, self.compression), &info)?;
        if in_real_time {
            recording.write_wall_clock();
        }
        self.recording = Some(recording);
        Ok(())
    }

    /// Every message of the run reaches this listener, too, whether or not the run is recorded.
    ///
    /// # Errors
    /// Never without a file; the recording's own otherwise.
    pub fn watch_live(
        &mut self,
        run: &RecordedRun<'_>,
        listener: Box<dyn MessageListener>,
    ) -> Result<(), RecordError> {
        self.is_watched = true;
        if self.recording.is_none() {
            let RecordedRun { robot, robot_toml, imu_baud, .. } = *run;
            let texts = BTreeMap::new();
            let info = RunInfo { robot, robot_toml, imu_baud, clouds_every: CLOUDS_EVERY, texts };
            let mut recording = RunRecorder::over(Recorder::without_file(), &info)?;
            recording.write_wall_clock();
            self.recording = Some(recording);
        }
        if let Some(recording) = &mut self.recording {
            recording.listen(listener);
        }
        Ok(())
    }

    /// Starts a recording of real devices.
    ///
    /// # Errors
    /// The file cannot be made.
    pub fn record_devices(&mut self, run: &RecordedRun<'_>, title: &str, path: &Path) -> anyhow::Result<()> {
        let texts = [("title", title), ("stages", Stages::All.name()), (REPEATABLE, IN_REAL_TIME)];
        self.record_run(run, &texts, path)
    }

    /// What a robot begins with goes into the recording, and at its end what it learned.
    fn learned_before(&mut self, learning: Option<&LearningSetup>) -> Option<(String, String)> {
        let learning = learning?;
        self.learning = learning.slot.clone();
        Some((LEARNED.to_owned(), learning.to_text()))
    }

    /// There is at least one sink.
    #[must_use]
    pub const fn listen(&self) -> bool {
        self.recording.is_some() || self.panel.is_some() || !self.links.is_empty()
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
        match (&mut self.panel, line) {
            (Some(panel), TapeLine::Lidar) => panel.lidar_datagram(data, Stamp::from_micros(when.1)),
            (Some(panel), TapeLine::Can) => panel.can_frame(data, Stamp::from_micros(when.1)),
            _ => {}
        }
    }

    /// A row of the tap becomes part of the order.
    pub fn ordered(&mut self, row: &TapRow, now_us: u64) {
        if self.recording.is_some() && self.order.note(row) {
            self.write_order(now_us);
        }
    }

    /// The rows so far have been taken in; `complete` when none was lost among them.
    pub fn rows_taken(&mut self, now_us: u64, complete: bool) {
        if !complete {
            self.order.lose();
        }
        self.write_order(now_us);
    }

    fn write_order(&mut self, now_us: u64) {
        if let (Some(recording), Some(entries)) = (&mut self.recording, self.order.take()) {
            recording.order(now_us, &entries);
        }
    }

    /// A frame of the robot on the bus.
    pub fn sent(&mut self, frame: &CanFrame, now_us: u64) {
        if let Some(recording) = &mut self.recording {
            recording.sent(frame, now_us);
        }
    }

    /// The cleaning mission has reported its progress, about once a second.
    pub fn mission(&mut self, progress: &Arc<MissionProgress>) {
        if let Some(recording) = &mut self.recording {
            recording.mission(progress);
        }
        if let Some(panel) = &mut self.panel {
            panel.mission(progress);
        }
    }

    /// The drive to a goal has reported its progress.
    pub fn navigation(&mut self, progress: &Arc<NavigationProgress>) {
        if let Some(recording) = &mut self.recording {
            recording.navigation(progress);
        }
        if let Some(panel) = &mut self.panel {
            panel.navigation(progress);
        }
        self.drive = Some(Arc::clone(progress));
    }

    /// A picture of the floor camera, about once a second; for people only.
    pub fn camera_picture(&mut self, picture: &ColourPicture) {
        if let Some(panel) = &mut self.panel {
            panel.camera_picture(picture);
        }
    }

    /// The floor camera's map of dirt.
    pub fn seen_dirt(&mut self, seen: &SeenDirt) {
        if let Some(recording) = &mut self.recording {
            recording.seen_dirt(seen);
        }
    }

    /// What really stands around a simulated robot, if somebody records it.
    pub fn true_world(
        &mut self,
        (at, odometry_in_world): (Stamp, Pose2),
        things: impl FnOnce() -> Vec<TrueSolid>,
    ) {
        if let Some(recording) = &mut self.recording {
            recording.true_world((at, odometry_in_world), &things());
        }
    }

    /// What has come into a simulated world, if somebody records it.
    pub fn true_things(&mut self, at: Stamp, things: impl FnOnce() -> Vec<TrueSolid>) {
        if let Some(recording) = &mut self.recording {
            recording.true_things(at, &things());
        }
    }

    /// The true state of a simulated robot and of everybody, if somebody records it.
    pub fn true_moment(
        &mut self,
        at: Stamp,
        robot: (Pose2, Twist2),
        people: impl FnOnce() -> Vec<TrueSolid>,
    ) {
        if let Some(recording) = &mut self.recording {
            recording.true_moment(at, robot, &people());
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
    pub fn attend<M: RawMutex>(&mut self, shared: &Shared<M>, now_us: u64) -> Vec<PanelOrder> {
        if self.panel.is_none() && self.links.is_empty() && !self.is_watched {
            return Vec::new();
        }
        let keeps_wall_time = self.links.iter().any(|link| link.keeps_wall_time());
        if self.panel.is_some() || self.is_watched || keeps_wall_time {
            let started = *self.started.get_or_insert_with(Instant::now);
            std::thread::sleep(Duration::from_micros(now_us).saturating_sub(started.elapsed()));
        }
        self.outside_orders(shared, now_us)
    }

    /// Shows the robot on the panel and to programs outside; gives what they have ordered meanwhile.
    pub(super) fn outside_orders<M: RawMutex>(&mut self, shared: &Shared<M>, now_us: u64) -> Vec<PanelOrder> {
        let mut orders: Vec<PanelOrder> = Vec::new();
        if let Some(panel) = &mut self.panel {
            panel.publish(shared);
            orders.extend(self.first_order.take().map(PanelOrder::Mission));
            orders.extend(std::iter::from_fn(|| panel.order()));
        }
        if !self.links.is_empty() {
            let (status, drive) = (shared.status.get(), self.drive.as_ref());
            let moment = LinkMoment { now: Stamp::from_micros(now_us), status: status.as_ref(), drive };
            let ordered = self.links.iter_mut().flat_map(|link| link.attend(&moment));
            orders.extend(ordered.map(PanelOrder::from));
        }
        orders
    }

    /// A mission can be ordered at the panel; the areas that are kept there reach it before anything else.
    pub fn set_mission(&mut self, setup: &MissionSetup) {
        let Some(panel) = &mut self.panel else { return };
        panel.set_mission(setup);
        self.missions = Some(setup.orders.clone());
        self.first_order = panel.kept_areas();
    }

    /// What operators have ordered reaches the tasks now.
    pub fn order<M: RawMutex>(&mut self, order: impl Into<PanelOrder>, shared: &Shared<M>, now_us: u64) {
        match order.into() {
            PanelOrder::Button(order) => {
                order.apply(shared);
                self.delivered((now_us, now_us), order.line(), &[]);
            }
            PanelOrder::Mission(order) => {
                let text = order.to_text();
                // A mission that does not take it does not take it in a replay either.
                if self.missions.as_ref().is_some_and(|missions| missions.push(order)) {
                    self.delivered((now_us, now_us), TapeLine::MissionOrder, text.as_bytes());
                }
            }
        }
    }

    /// What the tasks have published meanwhile is written.
    pub fn publish<M: RawMutex>(&mut self, shared: &Shared<M>, now_us: u64) {
        if let Some(recording) = &mut self.recording {
            recording.after_tasks(shared, now_us);
        }
    }

    /// The tasks have run, and everything that they put out is in the fingerprint.
    pub fn after_tasks<M: RawMutex>(&mut self, shared: &Shared<M>, (now_us, digest): (u64, u64)) {
        self.publish(shared, now_us);
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
