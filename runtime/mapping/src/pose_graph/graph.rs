//! Poses and edges.

use super::edge::Edge;
use crate::se2::Se2;

/// Poses, by index, and edges between them. Pose 0 stands still.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Graph {
    /// The poses, in the map.
    pub poses: Vec<Se2>,
    /// What is known about pairs.
    pub edges: Vec<Edge>,
}

impl Graph {
    /// Sum of the weighed squared errors of all edges.
    #[must_use]
    pub fn chi2(&self) -> f64 {
        self.edges.iter().map(|edge| self.edge_chi2(edge)).sum()
    }

    /// Weighed squared error of one edge; an edge to a pose that is not there counts 0.
    #[must_use]
    pub fn edge_chi2(&self, edge: &Edge) -> f64 {
        match (self.poses.get(edge.from), self.poses.get(edge.to)) {
            (Some(from), Some(to)) => edge.chi2(*from, *to),
            _ => 0.0,
        }
    }

    /// The pairs of poses, in the order of the edges.
    #[must_use]
    pub fn pairs(&self) -> Vec<[usize; 2]> {
        self.edges.iter().map(|edge| [edge.from, edge.to]).collect()
    }

    /// The poses moved by a step: three numbers for every pose but the first.
    #[must_use]
    pub fn moved(&self, step: &[f64]) -> Vec<Se2> {
        let mut poses = self.poses.clone();
        for (pose, step) in poses.iter_mut().skip(1).zip(step.chunks_exact(3)) {
            *pose = Se2::new(pose.x_m + step[0], pose.y_m + step[1], pose.heading_rad + step[2]);
        }
        poses
    }
}
