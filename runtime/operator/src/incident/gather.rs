//! Watches a replay and keeps what is needed around a moment.

use embassy_sync::blocking_mutex::raw::NoopRawMutex;
use floorguard_guard::{CauseRecord, Decision, SourceReport};
use floorguard_recording::replay::ReplayAudience;
use floorguard_runtime::configuration::RobotConfiguration;
use floorguard_runtime::shared::{PeopleReport, Shared, StampedPose};
use floorguard_types::geometry::Twist2;
use floorguard_types::time::Stamp;

use crate::surroundings::{Surroundings, followed, scan_hits};

/// So much before the moment is kept, microseconds.
const BEFORE_US: u64 = 10_000_000;
/// A stop that begins within so much of the moment is the one that is asked for, microseconds: lists of stops round to
/// tenths of a second.
const NEAR_US: u64 = 600_000;
/// A snapshot at least this often, microseconds.
const EVERY_US: u64 = 100_000;

/// What the robot knew and decided at a moment.
#[derive(Clone, Debug)]
pub struct Snapshot {
    /// When.
    pub at: Stamp,
    /// What was decided.
    pub decision: Decision,
    /// Every source.
    pub sources: Vec<SourceReport>,
    /// Every cause that held, as it began.
    pub causes: Vec<CauseRecord>,
    /// Where the robot was and how it moved.
    pub pose: StampedPose,
    /// What the mission asked for last.
    pub wanted: Option<Twist2>,
    /// What stood around it.
    pub around: Surroundings,
}

/// Keeps snapshots of the ten seconds before a moment.
pub struct Gather<'a> {
    robot: &'a RobotConfiguration,
    asked_us: u64,
    kept: Vec<Snapshot>,
    /// Where stops began near the moment: their index in `kept`.
    stops: Vec<usize>,
    last: Option<(u64, Decision)>,
}

impl<'a> Gather<'a> {
    /// For a robot and a moment on its clock.
    #[must_use]
    pub const fn new(robot: &'a RobotConfiguration, asked: Stamp) -> Self {
        Self { robot, asked_us: asked.as_micros(), kept: Vec::new(), stops: Vec::new(), last: None }
    }

    /// The moment that is meant is the last snapshot: the begin of a stop near the one that was asked for, or that one
    /// itself. The ten seconds before it come before it. Empty when the recording does not reach it.
    #[must_use]
    pub fn finish(self) -> Vec<Snapshot> {
        let distance = |index: &usize| {
            let at_us = self.kept.get(*index).map_or(u64::MAX, |snapshot| snapshot.at.as_micros());
            at_us.abs_diff(self.asked_us)
        };
        let begin = self.stops.iter().copied().min_by_key(distance);
        let before = |snapshot: &Snapshot| snapshot.at.as_micros() <= self.asked_us;
        let Some(last) = begin.or_else(|| self.kept.iter().rposition(before)) else { return Vec::new() };
        let mut kept = self.kept;
        kept.truncate(last + 1);
        let until_us = kept.last().map_or(0, |snapshot| snapshot.at.as_micros());
        kept.retain(|snapshot| snapshot.at.as_micros() + BEFORE_US >= until_us);
        kept
    }

    fn snapshot(&self, shared: &Shared<NoopRawMutex>, decision: Decision) -> Snapshot {
        let (sources, causes) =
            shared.inspect(|guard| (guard.health().to_vec(), guard.causes().copied().collect::<Vec<_>>()));
        let pose = shared.pose.get().unwrap_or_default();
        let set = self.robot.fields.get(decision.field_set);
        let mounting = self.robot.scanner.mounting.transform();
        let around = Surroundings {
            footprint: self.robot.geometry.footprint.to_vec(),
            protective: set.map(|set| set.protective.to_vec()).unwrap_or_default(),
            warning: set.map(|set| set.warning.to_vec()).unwrap_or_default(),
            hits: shared.scan.get().map(|scan| scan_hits(&scan, &mounting)).unwrap_or_default(),
            followed: followed(shared, pose.pose_in_odometry),
        };
        let sources = sources.into_iter().filter(|report| report.fitted).collect();
        let wanted = shared.wanted.get().map(|(_, wanted)| wanted);
        Snapshot { at: decision.stamp, decision, sources, causes, pose, wanted, around }
    }
}

/// What makes two decisions different for a reader.
fn shown(decision: &Decision) -> impl PartialEq {
    let cause = |record: Option<CauseRecord>| record.map(|record| record.cause);
    (decision.state, decision.action, cause(decision.primary_cause), cause(decision.holding_cause))
}

impl ReplayAudience for Gather<'_> {
    fn on_people(&mut self, _: &PeopleReport, _: u64) {}

    fn on_moment(&mut self, shared: &Shared<NoopRawMutex>, now_us: u64) {
        let first_us = self.asked_us.saturating_sub(BEFORE_US + NEAR_US);
        if now_us < first_us || now_us > self.asked_us.saturating_add(NEAR_US) {
            return;
        }
        let Some(decision) = shared.decision.get() else { return };
        let due = self.last.as_ref().is_none_or(|(last_us, last)| {
            now_us >= last_us.saturating_add(EVERY_US) || shown(last) != shown(&decision)
        });
        if !due {
            return;
        }
        let holds = |decision: &Decision| decision.action.stops() && !decision.escaping;
        let began = holds(&decision) && self.last.as_ref().is_some_and(|(_, last)| !holds(last));
        if began && now_us.abs_diff(self.asked_us) <= NEAR_US {
            self.stops.push(self.kept.len());
        }
        self.last = Some((now_us, decision));
        self.kept.push(self.snapshot(shared, decision));
    }
}
