//! Scans that are kept.

use floorguard_types::geometry::Point2;
use nalgebra::Matrix3;

use super::packed::PackedScan;
use crate::se2::Se2;

/// A scan that was matched and kept.
#[derive(Clone, Debug)]
pub struct Node {
    /// Seconds, on the clock of the log.
    pub time_s: f64,
    /// Scanner in the frame of the tracking, as it was matched.
    pub pose: Se2,
    /// Scanner in the frame of the odometry.
    pub odometry: Option<Se2>,
    /// The returns, in the scanner's frame, in the order of the beams; none any more once who keeps the scan has taken them.
    pub points: Box<[Point2]>,
    /// Inverse covariance of the pose, in the scanner's frame, as matched against the local map.
    pub information: Matrix3<f32>,
    /// Mean value of the match, 0 to 1.
    pub score: f32,
}

/// A scan between two kept ones: the tracking passes it over, the finished trajectory holds it.
#[derive(Clone, Debug)]
pub struct Passage {
    /// Seconds.
    pub time_s: f64,
    /// The kept scan before it.
    pub node: usize,
    /// Where it stands, seen from that scan, by odometry or by the last motion.
    pub from_node: Se2,
    /// The scan.
    pub scan: PackedScan,
}
