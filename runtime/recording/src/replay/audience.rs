//! Who watches a replay, and what comes of it.

use embassy_sync::blocking_mutex::raw::NoopRawMutex;
use floorguard_robot::learning::LearningReport;
use floorguard_runtime::shared::{PeopleReport, RobotStatus, Shared, StopRecord};
use floorguard_types::time::Stamp;

use crate::ReadError;

/// Who wants to see the robot's outputs while it is replayed.
pub trait ReplayAudience {
    /// A sweep was worked up; the fingerprint includes it.
    fn on_people(&mut self, report: &PeopleReport, digest: u64);
    /// Ten times a second.
    fn on_status(&mut self, _status: &RobotStatus) {}
    /// A stop began.
    fn on_stop(&mut self, _stop: &StopRecord) {}
    /// The tasks have run; this is what they know at this time, microseconds.
    fn on_moment(&mut self, _shared: &Shared<NoopRawMutex>, _now_us: u64) {}
}

/// How a replay went.
#[derive(Debug, Default)]
pub struct ReplayOutcome {
    /// Fingerprint of all outputs.
    pub digest: u64,
    /// Why its robot would be refused today; it was played all the same.
    pub findings: Option<String>,
    /// Why the raw bytes alone do not tell the whole run; nothing was compared then.
    pub unrepeatable: Option<String>,
    /// The recording's own, when it was closed properly.
    pub recorded_digest: Option<u64>,
    /// Fingerprints of moments within the recording that were compared.
    pub compared: u32,
    /// The first moment at which replay and recording differ.
    pub first_difference: Option<Stamp>,
    /// Robot time that was played, microseconds.
    pub played_us: u64,
    /// What the robot learned, if it does.
    pub learned: Option<LearningReport>,
    /// Why the recording ended early.
    pub ended: Option<ReadError>,
    /// Of a run in real time that holds its order: what was compared.
    pub order: Option<OrderOutcome>,
}

/// How the repetition of a run in real time went.
#[derive(Clone, Debug, Default)]
pub struct OrderOutcome {
    /// Polls of the guard ring.
    pub polls: u64,
    /// Decisions of then.
    pub decisions: u64,
    /// Frames that went out on the bus then.
    pub frames: u64,
    /// The first poll in which today's code decides or sends something else.
    pub first_difference: Option<Difference>,
    /// Rows of the recording are missing from here on; nothing after it was played.
    pub ends_at: Option<Stamp>,
}

/// Where today's code does something else.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Difference {
    /// When.
    pub at: Stamp,
    /// In which task of the guard ring.
    pub task: &'static str,
    /// What was decided or sent then.
    pub then: String,
    /// What today's code decides or sends.
    pub today: String,
}

impl ReplayOutcome {
    /// Every fingerprint of the recording was met.
    #[must_use]
    pub fn is_identical(&self) -> bool {
        let order = self.order.as_ref().is_none_or(|order| order.first_difference.is_none());
        order
            && self.first_difference.is_none()
            && self.recorded_digest.is_none_or(|digest| digest == self.digest)
    }
}

/// Why a recording cannot be replayed.
#[derive(Debug, thiserror::Error)]
pub enum ReplayError {
    /// It does not say what robot made it.
    #[error("the recording holds no raw bytes of floorguard: it was not made by --record")]
    NotOurs,
    /// What it says about the robot is wrong.
    #[error("the robot of the recording: {0}")]
    Robot(String),
    /// The entries of its order cannot be read.
    #[error("the order of its run cannot be read at {0:?}: another version of floorguard made it")]
    Order(Stamp),
    /// The tasks cannot run.
    #[error("{0}")]
    Tasks(String),
}
