//! The scans of the last metres as one cloud.

use std::collections::BTreeSet;

use floorguard_types::geometry::Point2;

use super::config::LocaliseConfig;
use crate::front_end::Node;

/// Returns of a search lie at least this far apart, metres.
const THIN_M: f32 = 0.2;

/// What is searched in the map.
pub struct Query {
    /// Index of the first scan in it.
    pub first: usize,
    /// Path between them, metres; a turn of one radian counts a metre.
    pub path_m: f64,
    /// Returns in the frame of the last scan.
    pub points: Vec<Point2>,
}

impl Query {
    /// From the last scans.
    pub fn new(nodes: &[Node], config: &LocaliseConfig) -> Option<Self> {
        let last = nodes.last()?;
        let (mut first, mut path_m) = (nodes.len() - 1, 0.0);
        while first > 0 && path_m < config.query_path_m {
            let step = nodes[first - 1].pose.between(nodes[first].pose);
            path_m += step.length_m() + step.heading_rad.abs();
            first -= 1;
        }
        let mut taken = BTreeSet::new();
        let mut points = Vec::new();
        for node in &nodes[first..] {
            let pose = last.pose.between(node.pose).single();
            for point in &node.points {
                let point = pose.transform(*point);
                let cell = ((point.x_m / THIN_M).floor() as i32, (point.y_m / THIN_M).floor() as i32);
                if taken.insert(cell) {
                    points.push(point);
                }
            }
        }
        let every = points.len().div_ceil(config.query_points.max(1)).max(1);
        let points = points.into_iter().step_by(every).collect();
        Some(Self { first, path_m, points })
    }
}
