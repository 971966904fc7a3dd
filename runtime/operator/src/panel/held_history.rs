//! What holds the robot, one after another, and what came of the resets: for the console, the verdict and the panel.

use floorguard_guard::{Cause, CauseRecord, ResetReport};
use floorguard_runtime::shared::RobotStatus;
use floorguard_types::time::Stamp;
use serde::Serialize;

use super::pieces::{self, Piece};
use super::plain::remedy;

/// What the history tells of.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum HeldKind {
    /// A cause that had not held the robot during this stop holds it now.
    Held,
    /// A reset was refused.
    ResetRefused,
    /// A reset was granted.
    ResetGranted,
}

impl HeldKind {
    /// In words.
    #[must_use]
    pub const fn words(self) -> &'static str {
        match self {
            Self::Held => "held by",
            Self::ResetRefused => "reset refused",
            Self::ResetGranted => "reset granted",
        }
    }
}

/// An entry of the history.
#[derive(Clone, Debug, PartialEq)]
pub struct HeldEvent {
    /// When, on the robot's clock.
    pub at: Stamp,
    /// What it tells of.
    pub kind: HeldKind,
    /// The cause, or what the reset met; without numbers.
    pub name: String,
    /// Which cause, or why; empty for a reset that was granted.
    pub text: String,
    /// The same piece by piece, for other languages.
    pub(super) pieces: Vec<Piece>,
    /// What helps; empty if there is nothing to do.
    pub remedy: &'static str,
}

impl HeldEvent {
    /// In one line, without the time.
    #[must_use]
    pub fn line(&self) -> String {
        let parts = [self.kind.words(), if self.text.is_empty() { "" } else { ": " }, &self.text];
        parts.concat()
    }
}

/// Compares one status with the one before.
#[derive(Clone, Copy, Debug, Default)]
pub struct HeldHistory {
    /// The causes that have held the robot during this stop, one bit for each [`Cause::index`]: causes that take turns are
    /// reported once.
    reported: u64,
    resets: ResetReport,
}

impl HeldHistory {
    /// What is new in a status. The cause that began a stop is none of it: that has a record of its own.
    pub fn news(&mut self, status: &RobotStatus) -> Vec<HeldEvent> {
        let mut news = Vec::new();
        news.extend(self.answered(&status.resets));
        let decision = &status.decision;
        let Some(record) = decision.holding_cause.filter(|record| record.action.stops()) else {
            self.reported = 0;
            return news;
        };
        if let Some(first) = decision.primary_cause.filter(|_| self.reported == 0) {
            self.reported = bit(first.cause);
        }
        if self.reported & bit(record.cause) == 0 {
            self.reported |= bit(record.cause);
            news.push(HeldEvent {
                at: decision.stamp,
                kind: HeldKind::Held,
                name: record.cause.to_string(),
                text: record.to_string(),
                pieces: pieces::of_cause(&record),
                remedy: remedy(&record),
            });
        }
        news
    }

    fn answered(&mut self, resets: &ResetReport) -> Option<HeldEvent> {
        let before = std::mem::replace(&mut self.resets, *resets);
        let at = resets.answered_at;
        if resets.refused > before.refused {
            let refusal = resets.refusal;
            let text = refusal.map(|why| why.to_string()).unwrap_or_default();
            let (kind, remedy) = (HeldKind::ResetRefused, refusal_remedy(resets, at));
            let pieces = pieces::of_refusal(refusal, remedy);
            Some(HeldEvent { at, kind, name: kind.words().to_owned(), text, pieces, remedy })
        } else if resets.granted > before.granted {
            self.reported = 0;
            Some(HeldEvent {
                at,
                kind: HeldKind::ResetGranted,
                name: HeldKind::ResetGranted.words().to_owned(),
                text: String::new(),
                pieces: Vec::new(),
                remedy: "Look around, then press start.",
            })
        } else {
            None
        }
    }
}

fn refusal_remedy(resets: &ResetReport, at: Stamp) -> &'static str {
    use floorguard_guard::ResetRefusal::{Moving, NotHealthy, Present};
    match resets.refusal {
        // The reset goes to the drive, too: its own fault may be gone by the next one.
        Some(Present(Cause::DriveFault)) => {
            "The reset has gone to the drive, too: press reset again. If it is refused again, clear the reason of the drive's \
             own fault."
        }
        Some(Present(cause)) => remedy(&CauseRecord::new(cause, at)),
        Some(NotHealthy(..)) => {
            "Wait until all sources are healthy, or see to the one that is not; then press reset again."
        }
        Some(Moving) => "Wait until the robot stands, then press reset again.",
        None => "",
    }
}

fn bit(cause: Cause) -> u64 {
    1_u64.wrapping_shl(cause.index() as u32)
}

#[cfg(test)]
mod tests {
    use super::*;
    use floorguard_guard::{Action, Decision, GuardState, ResetRefusal, Source};
    use floorguard_types::geometry::Twist2;

    fn status(first: Cause, holding: Cause, resets: ResetReport) -> RobotStatus {
        let record = |cause| Some(CauseRecord::new(cause, Stamp::ZERO));
        let decision = Decision {
            stamp: Stamp::ZERO,
            permitted: Twist2::ZERO,
            action: Action::Category2,
            speed_limit_mps: 0.0,
            state: GuardState::Latched,
            primary_cause: record(first),
            holding_cause: record(holding),
            torque_off: false,
            escaping: false,
            field_set: 0,
        };
        let guard = floorguard_guard::Supervisor::UNCONFIGURED;
        RobotStatus { decision, sources: guard.health(), pose: Default::default(), resets }
    }

    /// A stop that began with the start-up check: the emergency stop that is pressed meanwhile is reported, once.
    #[test]
    fn later_cause_is_reported_once() {
        let mut history = HeldHistory::default();
        let mut news = |holding| history.news(&status(Cause::StartUp, holding, ResetReport::NONE));
        assert_eq!(news(Cause::StartUp), []);
        let reported = news(Cause::EmergencyStop);
        assert_eq!(reported.len(), 1);
        assert!(reported[0].line().starts_with("held by: emergency stop pressed"), "{reported:?}");
        assert!(reported[0].remedy.starts_with("Release the emergency stop"), "{reported:?}");
        assert_eq!(news(Cause::StartUp).len() + news(Cause::EmergencyStop).len(), 0);
    }

    #[test]
    fn each_refused_reset_is_reported() {
        let mut history = HeldHistory::default();
        let why = ResetRefusal::NotHealthy(Source::Lidar, floorguard_guard::Health::Stale);
        for refused in 1..3 {
            let resets = ResetReport { refused, refusal: Some(why), ..ResetReport::NONE };
            let reported = history.news(&status(Cause::EmergencyStop, Cause::EmergencyStop, resets));
            assert_eq!(reported.len(), 1);
            assert_eq!(reported[0].line(), "reset refused: lidar is stale");
        }
        let resets = ResetReport { refused: 2, granted: 1, ..ResetReport::NONE };
        let reported = history.news(&status(Cause::EmergencyStop, Cause::EmergencyStop, resets));
        assert_eq!(reported[0].kind, HeldKind::ResetGranted);
    }
}
