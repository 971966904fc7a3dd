//! What goes out of a recording, under which name and with which quality.
//!
//! Sources: REP 103 and 105 (frames), REP 2003 (quality of sensors and maps), tf2 (`/tf`, `/tf_static`), the demos of nav2.

use floorguard_recording::topics;

use super::dds::Quality;

/// A topic of a recording in ROS 2.
#[derive(Clone, Copy, Debug)]
pub struct Published {
    /// In the recording.
    pub recorded: &'static str,
    /// In ROS 2.
    pub name: &'static str,
    /// Its type.
    pub kind: &'static str,
    /// What it offers.
    pub quality: Quality,
}

const fn row(recorded: &'static str, name: &'static str, kind: &'static str, quality: Quality) -> Published {
    Published { recorded, name, kind, quality }
}

const MARKERS: &str = "visualization_msgs/msg/MarkerArray";
const GRID: &str = "nav_msgs/msg/OccupancyGrid";
const TF: &str = "tf2_msgs/msg/TFMessage";
const TWIST: &str = "geometry_msgs/msg/TwistStamped";
const STATUS: &str = "diagnostic_msgs/msg/DiagnosticArray";

/// Everything that goes out of a recording. Raw bytes, the order of a run and the truth of a simulation do not.
pub const PUBLISHED: [Published; 18] = [
    row(topics::TF, "/tf", TF, Quality::Newest(100)),
    row(topics::TF_STATIC, "/tf_static", TF, Quality::Kept(8)),
    row(topics::ODOMETRY, "/odom", "nav_msgs/msg/Odometry", Quality::Newest(10)),
    row(topics::SCAN, "/scan", "sensor_msgs/msg/LaserScan", Quality::Newest(5)),
    row(topics::CLOUD, "/points", "sensor_msgs/msg/PointCloud2", Quality::Newest(2)),
    row(topics::IMU, "/imu", "sensor_msgs/msg/Imu", Quality::Newest(10)),
    row(topics::DETECTIONS, "/people", "vision_msgs/msg/Detection3DArray", Quality::Newest(5)),
    row(topics::PEOPLE, "/people/markers", MARKERS, Quality::Newest(2)),
    row(topics::FIELDS, "/guard/fields", MARKERS, Quality::Kept(1)),
    row(topics::PERMITTED, "/guard/permitted", TWIST, Quality::Newest(10)),
    row(topics::DIAGNOSTICS, "/diagnostics", STATUS, Quality::Newest(10)),
    row(topics::STOPS, "/guard/stops", STATUS, Quality::Kept(10)),
    row(topics::MAP, "/map", GRID, Quality::Kept(1)),
    row(topics::COSTMAP, "/costmap", GRID, Quality::Kept(1)),
    row(topics::PLAN, "/plan", "nav_msgs/msg/Path", Quality::Kept(1)),
    row(topics::CLAIMED, "/mission/claimed_clean", GRID, Quality::Kept(1)),
    row(topics::DIRT, "/mission/dirt", GRID, Quality::Kept(1)),
    row(topics::SEEN_DIRT, "/floor/seen_dirt", GRID, Quality::Kept(1)),
];

/// Its place among [`PUBLISHED`].
pub fn index_of(recorded: &str) -> Option<usize> {
    PUBLISHED.iter().position(|each| each.recorded == recorded)
}
