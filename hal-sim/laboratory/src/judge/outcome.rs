//! Whether a run came to what was asked for: good, failed or not finished, and why.

use floorguard_guard::CauseRecord;
use floorguard_types::geometry::Twist2;
use floorguard_types::time::Stamp;
use serde::Serialize;

use super::mission_outcome::MissionReport;
use super::navigation_outcome::NavigationReport;
use super::verdict::Verdict;
use crate::plan::Plan;
use floorguard_contact_judge::JobOutcome;
use floorguard_host::words::counted;

/// The value of a run.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Outcome {
    /// It ran as asked, and the judges found nothing.
    Good,
    /// The judges found something: a contact, a missed stop, a job undone.
    Failed,
    /// Nothing bad happened, and what was asked for was not reached.
    #[default]
    NotFinished,
}

impl Outcome {
    /// In words.
    #[must_use]
    pub const fn words(self) -> &'static str {
        match self {
            Self::Good => "good",
            Self::Failed => "FAILED",
            Self::NotFinished => "NOT FINISHED",
        }
    }
}

/// What was asked for.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Asked {
    /// How long the run was to last, seconds.
    pub duration_s: f64,
    /// The run was to end with a clean floor, and `duration_s` is the longest that it may take.
    pub until_clean: bool,
    /// A fault or a pressed emergency stop was asked for, too: the robot may stand for it.
    pub is_disturbed: bool,
    /// The route begins again at its end: it is never done.
    pub repeats: bool,
}

/// How the robot stood at the end.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Standing {
    /// Since when it has not moved, seconds since the start; none if it moved at the end.
    pub since_s: Option<f64>,
    /// What held it at the end, in words; none if nothing did.
    pub cause: Option<String>,
    /// Time after it was ready in which it stood and nothing held it, seconds.
    pub without_reason_s: f64,
}

/// Slower than this is standing, m/s and rad/s.
const MOVES: (f32, f32) = (0.02, 0.02);

impl Asked {
    /// Of a plan.
    #[must_use]
    pub const fn of(plan: &Plan) -> Self {
        Self {
            duration_s: plan.duration_us as f64 * 1.0e-6,
            until_clean: plan.until_clean,
            is_disturbed: !(plan.faults.is_empty() && plan.emergency_stop_us.is_empty()),
            repeats: plan.robot.route.repeat,
        }
    }
}

impl Standing {
    /// The true motion at a moment of the world.
    pub fn observe(&mut self, at: Stamp, motion: Twist2) {
        if motion.linear_mps.abs() > MOVES.0 || motion.angular_radps.abs() > MOVES.1 {
            self.since_s = None;
        } else {
            self.since_s.get_or_insert(at.as_micros() as f64 * 1.0e-6);
        }
    }

    /// What holds the robot, for so many seconds more in which it was ready.
    pub fn held(&mut self, cause: Option<CauseRecord>, ready_for_s: f64) {
        self.cause = cause.map(|record| record.to_string());
        if self.since_s.is_some() && cause.is_none() {
            self.without_reason_s += ready_for_s;
        }
    }
}

/// An end of a run that comes this much early was asked for by a person, seconds.
const EARLY_S: f64 = 0.5;
/// A robot that stands for less than this at the end is on its way, seconds.
const STANDS_S: f64 = 30.0;
/// Share of the time since it was ready in which it may stand.
const STANDS_SHARE: f64 = 0.5;
/// A robot farther off its place than this cannot say where it has cleaned, metres: half the width of a brush, and more
/// than the error with which its belief counts.
const OFF_PLACE_M: f64 = 0.5;

impl Verdict {
    /// Decides what the run comes to, and why.
    pub fn conclude(&mut self, asked: Asked, standing: &Standing) {
        let found = self.failures.join(", ");
        (self.verdict, self.reason) = match self.shortfall(asked, standing) {
            _ if !self.passed && self.has_harmed() => (Outcome::Failed, found),
            Some(reason) => (Outcome::NotFinished, reason),
            // It never moved, or left its job undone: where nothing was to be done, that is no fault.
            None if !self.passed && !self.is_done() => (Outcome::NotFinished, found),
            None => (Outcome::Good, self.achievement(asked)),
        };
    }

    /// The judges found something that must not happen, whatever became of the job.
    fn has_harmed(&self) -> bool {
        let counts = &self.bodies.counts;
        let false_claims = u32::from(self.navigation.as_ref().is_some_and(|drive| drive.false_claim));
        self.missed_stops + self.late_field_stops + self.avoidable_contacts + counts.went_on + false_claims
            > 0
    }

    /// Its mission has ended by itself.
    fn is_done(&self) -> bool {
        self.mission.as_ref().is_some_and(|mission| mission.finished)
            || self.navigation.as_ref().is_some_and(|drive| drive.reached)
    }

    /// What was asked for and not reached; the first that matters.
    fn shortfall(&self, asked: Asked, standing: &Standing) -> Option<String> {
        if let Some(drive) = &self.navigation {
            return drive.shortfall();
        }
        let is_done = self.is_done();
        if self.duration_s + EARLY_S < asked.duration_s && !(asked.until_clean && is_done) {
            return Some(format!(
                "ended by somebody after {:.1} of {:.1} s{}",
                self.duration_s,
                asked.duration_s,
                self.mission.as_ref().map(|mission| format!(", {}", mission.claims())).unwrap_or_default()
            ));
        }
        if self.ready_s.is_none() && !asked.is_disturbed && !is_done {
            let cause = standing.cause.as_deref().unwrap_or("no cause is known");
            return Some(format!("the robot never became ready to move: {cause}"));
        }
        self.off_place().or_else(|| self.stood(asked, standing)).or_else(|| self.unclean(asked))
    }

    /// The robot is not where it believes to be.
    fn off_place(&self) -> Option<String> {
        let off_m = self.mission.as_ref()?.localisation_error_max_m?;
        (off_m > OFF_PLACE_M).then(|| {
            format!("the robot was up to {off_m:.2} m off the place where it believed to be (limit {OFF_PLACE_M:.2} m)")
        })
    }

    /// It has stood for most of the time, and no disturbance was asked for.
    fn stood(&self, asked: Asked, standing: &Standing) -> Option<String> {
        let is_done = match &self.mission {
            Some(mission) => mission.finished,
            None if asked.repeats => self.bodies.job == JobOutcome::NoJob,
            None => matches!(self.bodies.job, JobOutcome::NoJob | JobOutcome::Done),
        };
        if is_done || asked.is_disturbed {
            return None;
        }
        let could_s = self.duration_s - self.ready_s.unwrap_or_default();
        if let Some(since_s) = standing.since_s
            && self.duration_s - since_s > STANDS_S.max(STANDS_SHARE * could_s)
        {
            let cause = standing.cause.as_deref().unwrap_or("nothing that it names holds it");
            return Some(format!("the robot stands since {since_s:.0} s: {cause}"));
        }
        let idle_s = standing.without_reason_s;
        (idle_s > STANDS_S.max(STANDS_SHARE * could_s)).then(|| {
            format!("the robot stood for {idle_s:.0} of {could_s:.0} s, and nothing that it names held it")
        })
    }

    /// The floor is not clean, although the mission says that it is over, or a clean floor was asked for.
    fn unclean(&self, asked: Asked) -> Option<String> {
        let mission = self.mission.as_ref()?;
        let ended = if mission.finished {
            "the mission has ended"
        } else if asked.until_clean {
            "the mission has not ended"
        } else {
            return None;
        };
        let is_left =
            !mission.finished || mission.claimed_cells < mission.dirty_cells || mission.lanes_left() > 0;
        is_left.then(|| format!("{ended}: {}", mission.claims()))
    }

    /// What a good run has come to.
    fn achievement(&self, asked: Asked) -> String {
        match &self.mission {
            Some(mission) if mission.finished => mission.claims(),
            Some(mission) => format!("ran as asked; mission in progress: {}", mission.claims()),
            None if self.navigation.is_some() => {
                self.navigation.as_ref().map(NavigationReport::words).unwrap_or_default()
            }
            None if self.ready_s.is_none() && asked.is_disturbed => {
                "ran as asked; the robot stood under what was put in".to_owned()
            }
            None => "ran as asked".to_owned(),
        }
    }
}

impl MissionReport {
    /// Lanes that nobody drove.
    #[must_use]
    pub fn lanes_left(&self) -> u32 {
        self.lanes.map_or(0, |lanes| lanes.planned.saturating_sub(lanes.driven))
    }

    /// What it claims, in words: lanes where it drives lanes, and cells that are proved clean.
    #[must_use]
    pub fn claims(&self) -> String {
        let cells = format!(
            "{} of {} claimed clean",
            self.claimed_cells,
            counted(u64::from(self.dirty_cells), "dirty cell")
        );
        match self.lanes {
            Some(lanes) => {
                format!("{} of {} driven, {cells}", lanes.driven, counted(u64::from(lanes.planned), "lane"))
            }
            None => cells,
        }
    }

    /// How it ended, in words. Only a guarantee can be reached; lanes end.
    #[must_use]
    pub fn end_in_words(&self) -> String {
        let Some(after_s) = self.finished_after_s else { return "not finished".to_owned() };
        match self.lanes {
            Some(_) => format!("lanes ended after {after_s:.0} s: {}", self.claims()),
            None if self.claimed_cells < self.dirty_cells => {
                format!("ended after {after_s:.0} s without the guarantee: {}", self.claims())
            }
            None => format!("guarantee reached after {after_s:.0} s"),
        }
    }
}

#[cfg(test)]
#[path = "outcome_tests.rs"]
mod tests;
