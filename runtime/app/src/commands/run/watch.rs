//! What the operator sees and reads while the robot runs.

mod devices;

use std::sync::Arc;
use std::sync::mpsc::Receiver;
use std::thread;
use std::time::{Duration, Instant};

use floorguard_guard::GuardState;
use floorguard_runtime::shared::{BusReport, Complaints, RobotStatus, StopRecord};
use serde_json::json;

use super::RunArguments;
use super::drive::WatchedDrive;
use super::service::Service;
use crate::commands::live::status_of;
use floorguard_host::console::Lines;
use floorguard_host::executor::StopFlag;
use floorguard_operator::display::LiveDisplay;
use floorguard_operator::panel::{HeldHistory, Order, remedy};
use floorguard_operator::telemetry::TelemetrySender;
use floorguard_robot::assembly::{HostedShared, write_stop_file};
use floorguard_robot::cleaner::{MissionPhase, MissionProgress, MissionSetup};
use floorguard_robot::environment::{Calendar, LiveLearner};
use floorguard_robot::learning::{LearningReport, LearningWriter};

/// How often the display reads the robot's state.
const POLL_PERIOD: Duration = Duration::from_millis(50);
/// With `--json` a status comes this often, seconds.
const JSON_STATUS_S: f64 = 1.0;

/// A word on the mission comes this often, seconds.
const MISSION_WORD_S: f64 = 10.0;

/// Shows the robot while it runs.
pub(super) struct Watch<'a> {
    arguments: &'a RunArguments,
    shared: &'a HostedShared,
    display: LiveDisplay,
    began: Instant,
    next_json_s: f64,
    pub(super) stops: u32,
    last_stop: Option<String>,
    history: HeldHistory,
    bus: Option<BusReport>,
    /// The devices on the bus that have not been heard of are named.
    silent_reported: bool,
    complaints: Complaints,
    pub(super) learner: Option<LiveLearner>,
    pub(super) learned: Option<LearningWriter>,
    pub(super) mission: Option<MissionSetup>,
    pub(super) drive: Option<WatchedDrive>,
    reported: u32,
    is_done: bool,
    next_mission_s: f64,
    lines: Lines,
    /// How many files could not be written, and why the first.
    pub(super) unwritten: Option<(u64, String)>,
    pub(super) notices: Option<Receiver<String>>,
}

impl<'a> Watch<'a> {
    pub(super) fn new(arguments: &'a RunArguments, shared: &'a HostedShared) -> Self {
        let display = LiveDisplay::new(arguments.outputs.duration.unwrap_or(0.0), arguments.outputs.json);
        let began = Instant::now();
        Self {
            arguments,
            shared,
            display,
            began,
            next_json_s: 0.0,
            stops: 0,
            last_stop: None,
            history: HeldHistory::default(),
            bus: None,
            silent_reported: false,
            complaints: Complaints::default(),
            learner: None,
            learned: None,
            mission: None,
            drive: None,
            reported: 0,
            is_done: false,
            next_mission_s: 0.0,
            lines: Lines::default(),
            unwritten: None,
            notices: None,
        }
    }

    pub(super) fn until_stopped(
        &mut self,
        flag: &StopFlag,
        typed: &Receiver<String>,
        notes: &TelemetrySender<'_>,
    ) {
        let ends_s = self.arguments.outputs.duration.unwrap_or(f64::INFINITY);
        let mut service = Service::ready();
        while !flag.is_stopped() && self.began.elapsed().as_secs_f64() < ends_s {
            thread::sleep(POLL_PERIOD);
            for line in typed.try_iter() {
                match line.trim() {
                    "r" | "R" => notes.order(Order::Reset),
                    "s" | "S" => notes.order(Order::Start),
                    _ => {}
                }
            }
            while let Some(stop) = self.shared.stops.try_pop() {
                notes.stop(&stop);
                self.on_stop(&stop);
            }
            let learned = self.learner.as_mut().map(|learner| learner.learn(self.shared, Calendar::now()));
            self.written(learned.unwrap_or(Ok(())));
            self.on_learning();
            if let Some(progress) = self.news_of_mission() {
                notes.mission(&progress);
                self.on_mission(&progress);
            }
            self.on_drive(flag, notes);
            if let Some(report) = self.shared.bus.get() {
                self.on_bus(&report);
            }
            self.on_complaints(&self.shared.complaints());
            for notice in self.notices.iter().flat_map(Receiver::try_iter) {
                self.display.note(&format!("  {notice}"));
            }
            if let Some(status) = self.shared.status.get() {
                service.decided(status.decision.stamp, Instant::now());
                self.on_status(&status);
            }
        }
    }

    /// Since the run began, seconds.
    pub(super) fn elapsed_s(&self) -> f64 {
        self.began.elapsed().as_secs_f64()
    }

    /// A word on the drive to a goal.
    pub(super) fn note_drive(&mut self, line: &serde_json::Value, words: &str) {
        if self.arguments.outputs.json {
            self.lines.tell(line);
        } else {
            self.display.note(&format!("  drive: {words}"));
        }
    }

    /// A failed write is reported and does not hold up the robot.
    fn written(&mut self, outcome: anyhow::Result<()>) {
        let Err(error) = outcome else { return };
        let what = format!("{error:#}");
        // Reported once: a full disk stays full, and the robot may run for months.
        let (files, _) = self.unwritten.get_or_insert_with(|| {
            self.display.note(&format!("  {what}; the robot goes on"));
            (0, what)
        });
        *files = files.saturating_add(1);
    }

    fn news_of_mission(&mut self) -> Option<Arc<MissionProgress>> {
        let watch = &self.mission.as_ref()?.watch;
        let reported = std::mem::replace(&mut self.reported, watch.published());
        if reported == self.reported { None } else { watch.get() }
    }

    /// Accepted updates are written to their file and reported.
    fn on_learning(&mut self) {
        let Some(writer) = &mut self.learned else { return };
        let Some(update) = writer.attend() else { return };
        if self.arguments.outputs.json {
            self.print_learned();
        } else {
            self.display.note(&format!("  {update}"));
        }
    }

    fn print_learned(&mut self) {
        let report: Option<LearningReport> = self.learned.as_ref().and_then(LearningWriter::report);
        if let Some(report) = report {
            let elapsed_s = self.began.elapsed().as_secs_f64();
            self.lines.tell(&json!({"type": "learning", "time_s": elapsed_s, "learned": report}));
        }
    }

    /// At the end.
    pub(super) fn reports_learned_state(&mut self) {
        self.on_learning();
        if let Some(report) = self.learned.as_ref().and_then(LearningWriter::report) {
            if self.arguments.outputs.json {
                self.print_learned();
            }
            say!("floorguard run: learned: {}", report.words());
        }
    }

    /// The mission has reported its progress: every ten seconds, and when it is done.
    fn on_mission(&mut self, progress: &MissionProgress) {
        let elapsed_s = self.began.elapsed().as_secs_f64();
        let is_done = progress.phase == MissionPhase::Done && !self.is_done;
        self.is_done |= is_done;
        if self.arguments.outputs.json {
            self.lines.tell(&json!({
                "type": "mission",
                "time_s": elapsed_s,
                "phase": progress.phase.name(),
                "completion": progress.completion,
                "claimed_fraction": progress.claimed_fraction,
                "uncertain_cells": progress.uncertain.len(),
                "unreachable_cells": progress.unreachable_cells,
                "distance_m": progress.distance_m,
            }));
        } else if is_done || elapsed_s >= self.next_mission_s {
            self.next_mission_s = elapsed_s + MISSION_WORD_S;
            self.display.note(&format!("  mission: {}", progress.words()));
        }
    }

    pub(super) fn on_stop(&mut self, stop: &StopRecord) {
        self.stops += 1;
        let at_s = stop.stamp.as_micros() as f64 * 1.0e-6;
        self.last_stop = Some(format!("{at_s:.1} s: {}", stop.cause));
        if let Some(folder) = &self.arguments.outputs.black_box {
            let outcome = write_stop_file(folder, self.stops, (stop, self.shared));
            self.written(outcome.map(drop));
        }
        if self.arguments.outputs.json {
            let cause = stop.cause.to_string();
            let latched = stop.state == GuardState::Latched;
            let line = json!({"type": "stop", "time_s": at_s, "cause": cause, "speed_mps": stop.speed_mps, "latched": latched});
            self.lines.tell(&line);
        }
    }

    /// What holds the robot has changed, or a reset was answered.
    fn on_history(&mut self, status: &RobotStatus) {
        for event in self.history.news(status) {
            let (at_s, line) = (event.at.as_micros() as f64 * 1.0e-6, event.line());
            if self.arguments.outputs.json {
                self.lines
                    .tell(&json!({"type": event.kind, "time_s": at_s, "text": line, "remedy": event.remedy}));
            } else {
                self.display.note(&format!("  {at_s:.1} s: {line}. {}", event.remedy));
            }
        }
    }

    fn on_status(&mut self, status: &RobotStatus) {
        self.on_history(status);
        let elapsed_s = self.began.elapsed().as_secs_f64();
        let people = self.shared.people.get().map_or(0, |report| report.people.len());
        let mut seen = status_of(elapsed_s, status, (people, self.stops, self.last_stop.clone()));
        let progress = self.mission.as_ref().and_then(|mission| mission.watch.get());
        seen.mission = progress.map(|progress| progress.words());
        if self.arguments.outputs.json && elapsed_s >= self.next_json_s {
            self.next_json_s = elapsed_s + JSON_STATUS_S;
            let sources: serde_json::Map<String, serde_json::Value> = seen
                .sources
                .iter()
                .map(|source| (source.name.clone(), source.health.clone().into()))
                .collect();
            let links = self.shared.links();
            self.lines.tell(
                &json!({"type": "status", "time_s": elapsed_s, "state": format!("{:?}", status.decision.state),
                "speed_mps": seen.speed_mps, "limit_mps": seen.limit_mps, "people": seen.people,
                "held_by": status.decision.holding_cause.map(|record| record.to_string()),
                "remedy": status.decision.holding_cause.map(|record| remedy(&record)),
                "first_cause": status.decision.primary_cause.map(|record| record.to_string()),
                "sources": sources, "can_sent": links.can_sent, "can_errors": links.can_errors}),
            );
        }
        if self.display.is_due(elapsed_s) {
            self.display.show(&seen);
        }
    }
}
