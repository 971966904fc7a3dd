//! What a run writes, and under which topic: one method per kind of message.

use std::io::{Seek, Write};

use floorguard_types::geometry::{Pose2, Transform3, Twist2};
use floorguard_types::sensing::{ImuSample, Scan};
use floorguard_types::time::Stamp;

use super::messages::{self, Diagnostic, GridImage, Marker, PointRow};
use super::recorder::{RecordError, Recorder};
use super::schemas;
use super::times::Times;

/// Points of a sweep.
pub const CLOUD: &str = "/lidar/points";
/// Scans of the safety scanner.
pub const SCAN: &str = "/scanner/scan";
/// Inertial samples.
pub const IMU: &str = "/imu";
/// The robot's motion.
pub const ODOMETRY: &str = "/odometry";
/// Moving frames.
pub const TF: &str = "/tf";
/// Mountings.
pub const TF_STATIC: &str = "/tf_static";
/// What the scanner has seen free and occupied, in the odometry frame.
pub const MAP: &str = "/map";
/// What the mission claims to be clean, percent: 0 dirty, 50 uncertain, 100 claimed.
pub const CLAIMED: &str = "/mission/claimed_clean";
/// Expected dirt, percent of the dirtiest cell before the mission; the first message is that before it.
pub const DIRT: &str = "/mission/dirt";
/// Dirt that the floor camera saw.
pub const SEEN_DIRT: &str = "/floor/seen_dirt";
/// The rest of the path that the robot drives to its goal, in the map's frame.
pub const PLAN: &str = "/navigation/plan";
/// The costmap around the robot, percent: 0 free, 100 an obstacle, −1 unknown.
pub const COSTMAP: &str = "/navigation/costmap";
/// Tracks of people.
pub const PEOPLE: &str = "/people";
/// The same tracks as detections.
pub const DETECTIONS: &str = "/people/detections";
/// The clock on the wall beside the robot's, once a second of a run in real time.
pub const WALL_CLOCK: &str = "/wall_clock";
/// The fields that the guard watches.
pub const FIELDS: &str = "/guard/fields";
/// The permitted command.
pub const PERMITTED: &str = "/guard/permitted";
/// The measured speed, where there is no odometry.
pub const MEASURED: &str = "/guard/measured";
/// The greatest permitted speed.
pub const SPEED_LIMIT: &str = "/guard/speed_limit";
/// Every stop.
pub const STOPS: &str = "/guard/stops";
/// Sources and counters.
pub const DIAGNOSTICS: &str = "/diagnostics";
/// The order of a run in real time: polls of the guard ring, what reached them and what was decided.
pub const ORDER: &str = "/guard/order";
/// The fingerprint of the outputs, now and then.
pub const DIGEST: &str = "/floorguard/digest";

/// The robot's motion at one moment.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MotionRow {
    /// When.
    pub stamp: Stamp,
    /// Pose in the odometry frame.
    pub pose_in_odom: Pose2,
    /// Speed in the robot's frame.
    pub twist: Twist2,
    /// Covariance of x, y, heading.
    pub covariance: [[f32; 3]; 3],
}

impl<W: Write + Seek> Recorder<W> {
    /// A sweep, as points in `frame`.
    ///
    /// # Errors
    /// When the file cannot be written.
    pub fn points(
        &mut self,
        times: impl Into<Times>,
        (stamp, frame): (Stamp, &str),
        points: &[PointRow],
    ) -> Result<(), RecordError> {
        self.message(CLOUD, &schemas::POINT_CLOUD, times, &messages::point_cloud(stamp, frame, points))
    }

    /// A scan of the safety scanner.
    ///
    /// # Errors
    /// When the file cannot be written.
    pub fn scan(&mut self, logged: Stamp, scan: &Scan) -> Result<(), RecordError> {
        let times = Times { logged, published: scan.stamp };
        let turn_s = self.turns.turn_s(scan);
        self.message(SCAN, &schemas::LASER_SCAN, times, &messages::laser_scan(scan, turn_s, "scanner"))
    }

    /// A sample of the inertial unit.
    ///
    /// # Errors
    /// When the file cannot be written.
    pub fn imu(&mut self, logged: Stamp, sample: &ImuSample) -> Result<(), RecordError> {
        let times = Times { logged, published: sample.stamp };
        self.message(IMU, &schemas::IMU, times, &messages::imu(sample, "imu"))
    }

    /// The robot's motion: odometry and the frame tree.
    ///
    /// # Errors
    /// When the file cannot be written.
    pub fn motion(&mut self, logged: Stamp, row: &MotionRow) -> Result<(), RecordError> {
        let times = Times { logged, published: row.stamp };
        let odometry = messages::odometry(row.stamp, row.pose_in_odom, row.twist, &row.covariance);
        self.message(ODOMETRY, &schemas::ODOMETRY, times, &odometry)?;
        self.frame(times, row.stamp, (("odom", "base_link"), row.pose_in_odom))
    }

    /// A moving frame on the plane of its parent.
    ///
    /// # Errors
    /// When the file cannot be written.
    pub fn frame(
        &mut self,
        times: impl Into<Times>,
        stamp: Stamp,
        ((parent, child), at): ((&str, &str), Pose2),
    ) -> Result<(), RecordError> {
        let frame = messages::flat_frame(stamp, (parent, child), at);
        self.message(TF, &schemas::TF_MESSAGE, times, &frame)
    }

    /// Where a sensor is mounted.
    ///
    /// # Errors
    /// When the file cannot be written.
    pub fn mounting(&mut self, at: Stamp, child: &str, in_base: &Transform3) -> Result<(), RecordError> {
        self.message(
            TF_STATIC,
            &schemas::TF_MESSAGE,
            at,
            &messages::mounting(at, "base_link", child, in_base),
        )
    }

    /// A map in a frame.
    ///
    /// # Errors
    /// When the file cannot be written.
    pub fn map(
        &mut self,
        topic: &'static str,
        (at, frame): (Stamp, &str),
        grid: &GridImage,
    ) -> Result<(), RecordError> {
        self.message(topic, &schemas::OCCUPANCY_GRID, at, &messages::occupancy_grid(at, frame, grid))
    }

    /// A planned path in a frame.
    ///
    /// # Errors
    /// When the file cannot be written.
    pub fn path(
        &mut self,
        topic: &'static str,
        (at, frame): (Stamp, &str),
        poses: &[Pose2],
    ) -> Result<(), RecordError> {
        self.message(topic, &schemas::PATH, at, &messages::path(at, frame, poses))
    }

    /// People, fields and the like, drawn.
    ///
    /// # Errors
    /// When the file cannot be written.
    pub fn markers(
        &mut self,
        topic: &'static str,
        (at, frame): (Stamp, &str),
        drawn: &[Marker],
    ) -> Result<(), RecordError> {
        self.message(topic, &schemas::MARKER_ARRAY, at, &messages::markers(at, frame, drawn))
    }

    /// Health of the sources, counters, stops.
    ///
    /// # Errors
    /// When the file cannot be written.
    pub fn diagnostics(
        &mut self,
        topic: &'static str,
        at: Stamp,
        list: &[Diagnostic],
    ) -> Result<(), RecordError> {
        self.message(topic, &schemas::DIAGNOSTIC_ARRAY, at, &messages::diagnostics(at, list))
    }

    /// What the guard permits: command and limit.
    ///
    /// # Errors
    /// When the file cannot be written.
    pub fn permitted(&mut self, at: Stamp, command: Twist2, limit_mps: f32) -> Result<(), RecordError> {
        self.message(PERMITTED, &schemas::TWIST_STAMPED, at, &messages::twist(at, command))?;
        self.message(SPEED_LIMIT, &schemas::NUMBER, at, &messages::number(limit_mps))
    }

    /// How the robot moved, from a log without poses.
    ///
    /// # Errors
    /// When the file cannot be written.
    pub fn measured(&mut self, at: Stamp, speed: Twist2) -> Result<(), RecordError> {
        self.message(MEASURED, &schemas::TWIST_STAMPED, at, &messages::twist(at, speed))
    }

    /// Entries of the order of a run in real time.
    ///
    /// # Errors
    /// When the file cannot be written.
    pub fn order(&mut self, at: Stamp, entries: &[u8]) -> Result<(), RecordError> {
        self.message(ORDER, &schemas::OCTETS, at, &messages::octets(entries))
    }

    /// The fingerprint of everything that the robot has put out up to this moment.
    ///
    /// # Errors
    /// When the file cannot be written.
    pub fn digest(&mut self, at: Stamp, digest: u64) -> Result<(), RecordError> {
        self.message(DIGEST, &schemas::TEXT, at, &messages::text(&format!("{digest:016x}")))
    }
}
