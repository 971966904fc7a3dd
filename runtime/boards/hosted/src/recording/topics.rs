//! What a run writes, and under which topic: one method per kind of message.

use std::io::{Seek, Write};

use floorguard_core::geometry::{Pose2, Transform3, Twist2};
use floorguard_core::sensing::{ImuSample, Scan};
use floorguard_core::time::Stamp;

use super::messages::{self, Diagnostic, GridImage, Marker, PointRow};
use super::recorder::{RecordError, Recorder};
use super::schemas;

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
    pub fn points(&mut self, stamp: Stamp, frame: &str, points: &[PointRow]) -> Result<(), RecordError> {
        self.message(
            "/lidar/points",
            &schemas::POINT_CLOUD,
            stamp,
            &messages::point_cloud(stamp, frame, points),
        )
    }

    /// A scan of the safety scanner.
    ///
    /// # Errors
    /// When the file cannot be written.
    pub fn scan(&mut self, scan: &Scan) -> Result<(), RecordError> {
        self.message(
            "/scanner/scan",
            &schemas::LASER_SCAN,
            scan.stamp,
            &messages::laser_scan(scan, "scanner"),
        )
    }

    /// A sample of the inertial unit.
    ///
    /// # Errors
    /// When the file cannot be written.
    pub fn imu(&mut self, sample: &ImuSample) -> Result<(), RecordError> {
        self.message("/imu", &schemas::IMU, sample.stamp, &messages::imu(sample, "imu"))
    }

    /// The robot's motion: odometry and the frame tree.
    ///
    /// # Errors
    /// When the file cannot be written.
    pub fn motion(&mut self, row: &MotionRow) -> Result<(), RecordError> {
        let odometry = messages::odometry(row.stamp, row.pose_in_odom, row.twist, &row.covariance);
        self.message("/odometry", &schemas::ODOMETRY, row.stamp, &odometry)?;
        let frame = messages::robot_pose(row.stamp, "odom", row.pose_in_odom);
        self.message("/tf", &schemas::TF_MESSAGE, row.stamp, &frame)
    }

    /// Where a sensor is mounted.
    ///
    /// # Errors
    /// When the file cannot be written.
    pub fn mounting(&mut self, at: Stamp, child: &str, in_base: &Transform3) -> Result<(), RecordError> {
        self.message(
            "/tf_static",
            &schemas::TF_MESSAGE,
            at,
            &messages::mounting(at, "base_link", child, in_base),
        )
    }

    /// A map.
    ///
    /// # Errors
    /// When the file cannot be written.
    pub fn map(&mut self, topic: &'static str, at: Stamp, grid: &GridImage) -> Result<(), RecordError> {
        self.message(topic, &schemas::OCCUPANCY_GRID, at, &messages::occupancy_grid(at, "odom", grid))
    }

    /// People, fields and the like, drawn.
    ///
    /// # Errors
    /// When the file cannot be written.
    pub fn markers(&mut self, at: Stamp, frame: &str, drawn: &[Marker]) -> Result<(), RecordError> {
        self.message("/people", &schemas::MARKER_ARRAY, at, &messages::markers(at, frame, drawn))
    }

    /// Health of the sources and causes of stops.
    ///
    /// # Errors
    /// When the file cannot be written.
    pub fn diagnostics(&mut self, at: Stamp, list: &[Diagnostic]) -> Result<(), RecordError> {
        self.message("/diagnostics", &schemas::DIAGNOSTIC_ARRAY, at, &messages::diagnostics(at, list))
    }
}
