//! What the robot tells about itself: people, health, links.

use floorguard_guard::{Decision, ResetReport, Source, SourceReport};
use floorguard_perception::people::{Explanation, PeopleCounters, SensorSet, TrackStatus};
use floorguard_types::geometry::Point2;
use floorguard_types::profile::{ListOf, Native, Profile};
use floorguard_types::time::Stamp;

use super::motion::StampedPose;

/// A track, for display, recording and judgement.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PersonReport {
    /// Unique since the start.
    pub id: u32,
    /// Seen often enough.
    pub status: TrackStatus,
    /// In the odometry frame, metres.
    pub position: Point2,
    /// In the odometry frame, m/s.
    pub velocity_mps: Point2,
    /// Standard deviation of the position, metres.
    pub position_sigma_m: f32,
    /// Standard deviation of the velocity, m/s.
    pub velocity_sigma_mps: f32,
    /// Belief that it is a person, 0…1.
    pub person_probability: f32,
    /// Belief that it moves, 0…1.
    pub moving_probability: f32,
    /// Who has seen it within the last half second.
    pub sensors: SensorSet,
    /// What explains it, if it is no person in spite of its probability.
    pub explanation: Option<Explanation>,
}

/// About one sweep.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct SweepReport {
    /// When its last column was measured.
    pub stamp: Stamp,
    /// Where its returns went.
    pub counters: PeopleCounters,
    /// Packets missing in it.
    pub lost_packets: u16,
}

/// What perception made of the newest sweep; while the lidar is silent, of the newest scan: then it counts no returns.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct PeopleReport {
    /// The sweep.
    pub sweep: SweepReport,
    /// All tracks.
    pub people: ListOf<PersonReport, <Native as Profile>::Tracks>,
    /// Sweeps whose pose was not known and which were not used.
    pub unposed_sweeps: u32,
    /// The same of scans, which were not searched for legs.
    pub unposed_scans: u32,
}

/// How everything is.
#[derive(Clone, Debug, PartialEq)]
pub struct RobotStatus {
    /// The newest decision.
    pub decision: Decision,
    /// Every source.
    pub sources: [SourceReport; Source::COUNT],
    /// Where the robot believes to be.
    pub pose: StampedPose,
    /// What came of the operator's resets.
    pub resets: ResetReport,
}

/// What happened on the links; saturating.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct LinkCounters {
    /// Invalid lidar datagrams.
    pub lidar_refused: u32,
    /// Failures of the lidar's socket.
    pub lidar_errors: u32,
    /// Telegrams of the scanner that are right and of no use.
    pub scanner_refused: u32,
    /// Failures of the scanner's line.
    pub scanner_errors: u32,
    /// Telegrams of the second scanner that are right and of no use.
    pub rear_scanner_refused: u32,
    /// Failures of the second scanner's line.
    pub rear_scanner_errors: u32,
    /// Failures of the inertial sensor's line.
    pub imu_errors: u32,
    /// Failures of the CAN bus.
    pub can_errors: u32,
    /// Frames sent.
    pub can_sent: u32,
}
