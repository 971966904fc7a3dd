//! Kept scans as a chain of edges.

use nalgebra::Matrix3;

use super::node::Node;
use crate::pose_graph::{Edge, EdgeKind};

/// Deviation of a step that the match did not hold, for each metre and radian of the step, and at rest.
const STEP_M: f64 = 0.05;
const STEP_SHARE: f64 = 0.1;
const STEP_RAD: f64 = 0.03;

/// One edge from each scan to the next: what the match says in the frame of the later scan, and what odometry adds where
/// the match leaves a direction open.
#[must_use]
pub fn sequence_edges(nodes: &[Node]) -> Vec<Edge> {
    let edge = |(index, pair): (usize, &[Node])| {
        let [before, after] = pair else { return None };
        let measured = before.pose.between(after.pose);
        let distance = measured.length_m();
        let turn = measured.heading_rad.abs();
        let place = 1.0 / (STEP_M + STEP_SHARE * (distance + turn)).powi(2);
        let heading = 1.0 / (STEP_RAD + STEP_SHARE * (turn + 0.3 * distance)).powi(2);
        let information =
            after.information.map(f64::from) + Matrix3::from_diagonal(&[place, place, heading].into());
        Some(Edge { from: index, to: index + 1, measured, information, kind: EdgeKind::Sequence })
    };
    nodes.windows(2).enumerate().filter_map(edge).collect()
}
