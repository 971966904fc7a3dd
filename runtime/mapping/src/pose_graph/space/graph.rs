//! The most likely poses in space; wrong loops do not bend them.

use floorguard_mapping::lidar_odometry::Pose3;
use nalgebra::{Matrix3, Matrix6, Vector3, Vector6};

use super::edge::SpaceEdge;
use crate::pose_graph::block_system::{BlockSystem, PairTerms, Unsolvable};
use crate::pose_graph::robust::truncated_weight;
use crate::pose_graph::{EdgeKind, OptimiseConfig, Optimised, RobustConfig};

/// Poses, by index, and edges between them. Pose 0 stands still.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct SpaceGraph {
    /// The poses, in the map.
    pub poses: Vec<Pose3>,
    /// What is known about pairs.
    pub edges: Vec<SpaceEdge>,
}

/// Squared error beyond which a loop of six numbers is wrong: a right one is so once in a thousand times.
pub const SPACE_CHI2_LIMIT: f64 = 22.46;
/// Pairs of blocks that an edge fills.
const PAIRS: usize = 6;

/// Blocks of the equations: one for the rotation of a pose, one for its place; both of pose 0 are block 0, which is held.
fn blocks(pose: usize) -> [usize; 2] {
    if pose == 0 { [0, 0] } else { [2 * pose - 1, 2 * pose] }
}

impl SpaceGraph {
    /// Weighed squared error of one edge; an edge to a pose that is not there counts 0.
    #[must_use]
    pub fn edge_chi2(&self, edge: &SpaceEdge) -> f64 {
        match (self.poses.get(edge.from), self.poses.get(edge.to)) {
            (Some(from), Some(to)) => edge.chi2(from, to),
            _ => 0.0,
        }
    }

    /// Moves the poses to the least error of the edges that agree: graduated non-convexity with a truncated square (Yang et
    /// al. 2020), as on the plane. Answers the weight of each edge, 0 or 1. Edges of the sequence always count.
    ///
    /// # Errors
    /// A part of the graph hangs on nothing.
    pub fn optimise_robustly(&mut self, config: &RobustConfig) -> Result<Vec<f64>, Unsolvable> {
        let mut system = self.system();
        let limit = SPACE_CHI2_LIMIT;
        let is_loop = |edge: &SpaceEdge| edge.kind == EdgeKind::Loop;
        let worst = self.edges.iter().filter(|edge| is_loop(edge)).map(|edge| self.edge_chi2(edge));
        let worst = worst.fold(0.0, f64::max);
        let mut control = if worst > limit { limit / (2.0 * worst - limit) } else { f64::INFINITY };
        let mut weights = vec![1.0; self.edges.len()];
        for round in 0..config.rounds_max {
            if !control.is_finite() {
                break;
            }
            let mut undecided = 0;
            for (edge, weight) in self.edges.iter().zip(&mut weights).filter(|(edge, _)| is_loop(edge)) {
                *weight = truncated_weight(self.edge_chi2(edge), limit, control);
                undecided += usize::from(*weight > 0.0 && *weight < 0.999);
            }
            self.optimise_with(&mut system, &weights, &config.round)?;
            if undecided == 0 && round > 2 {
                break;
            }
            control *= config.growth;
        }
        for (edge, weight) in self.edges.iter().zip(&mut weights).filter(|(edge, _)| is_loop(edge)) {
            *weight = f64::from(u8::from(self.edge_chi2(edge) <= limit));
        }
        self.optimise_with(&mut system, &weights, &config.last)?;
        Ok(weights)
    }

    /// Moves the poses to the least sum of weighed squared errors, every edge counted.
    ///
    /// # Errors
    /// A part of the graph hangs on nothing.
    pub fn optimise(&mut self, config: &OptimiseConfig) -> Result<Optimised, Unsolvable> {
        let mut system = self.system();
        let weights = vec![1.0; self.edges.len()];
        self.optimise_with(&mut system, &weights, config)
    }

    fn system(&self) -> BlockSystem {
        let pairs = self.edges.iter().flat_map(|edge| {
            let ([a, b], [c, d]) = (blocks(edge.from), blocks(edge.to));
            [[a, b], [c, d], [a, c], [a, d], [b, c], [b, d]]
        });
        BlockSystem::new((2 * self.poses.len()).saturating_sub(1), &pairs.collect::<Vec<_>>())
    }

    fn chi2(&self, weights: &[f64]) -> f64 {
        self.edges.iter().zip(weights).map(|(edge, weight)| weight * self.edge_chi2(edge)).sum()
    }

    /// Gauss-Newton where it goes down, damped where it does not.
    fn optimise_with(
        &mut self,
        system: &mut BlockSystem,
        weights: &[f64],
        config: &OptimiseConfig,
    ) -> Result<Optimised, Unsolvable> {
        let mut chi2 = self.chi2(weights);
        let mut damping = 0.0_f64;
        for steps in 1..=config.steps_max {
            self.linearise(system, weights);
            if damping > 0.0 {
                system.damp(damping);
            }
            let step = match system.solve() {
                Ok(step) => step,
                Err(error) if damping > 1.0e3 => return Err(error),
                Err(_) => {
                    damping = (damping * 10.0).max(1.0e-6);
                    continue;
                }
            };
            let before = self.poses.clone();
            self.step(&step);
            let after = self.chi2(weights);
            if after > chi2 {
                self.poses = before;
                damping = (damping * 10.0).max(1.0e-6);
                if damping > 1.0e12 {
                    return Ok(Optimised { chi2, steps, has_converged: true });
                }
                continue;
            }
            damping = if damping < 1.0e-8 { 0.0 } else { damping * 0.1 };
            let gain = chi2 - after;
            chi2 = after;
            if gain <= config.share_least * chi2.max(1.0e-12) {
                return Ok(Optimised { chi2, steps, has_converged: true });
            }
        }
        Ok(Optimised { chi2, steps: config.steps_max, has_converged: false })
    }

    fn step(&mut self, step: &[f64]) {
        for (pose, step) in self.poses.iter_mut().skip(1).zip(step.chunks_exact(6)) {
            *pose =
                pose.moved(Vector3::new(step[0], step[1], step[2]), Vector3::new(step[3], step[4], step[5]));
        }
    }

    fn linearise(&self, system: &mut BlockSystem, weights: &[f64]) {
        system.clear();
        for (index, (edge, weight)) in self.edges.iter().zip(weights).enumerate() {
            let (Some(from), Some(to)) = (self.poses.get(edge.from), self.poses.get(edge.to)) else {
                continue;
            };
            let error = edge.error(from, to);
            let by = edge.derivatives(from, to);
            let information = edge.information * *weight;
            let pull = information * error;
            let own = |j: &Matrix6<f64>| (j.transpose() * information * j, j.transpose() * pull);
            let mixed = by.first.transpose() * information * by.second;
            for (pair, j) in [&by.first, &by.second].into_iter().enumerate() {
                let (matrix, gradient) = own(j);
                system.add(PAIRS * index + pair, &diagonal_terms(&matrix, &gradient));
            }
            for (pair, [row, column]) in [[0, 0], [0, 3], [3, 0], [3, 3]].into_iter().enumerate() {
                let block = mixed.fixed_view::<3, 3>(row, column).into_owned();
                system.add(PAIRS * index + 2 + pair, &mixed_terms(block));
            }
        }
    }
}

/// What an edge adds for rotation and place of one pose.
fn diagonal_terms(matrix: &Matrix6<f64>, gradient: &Vector6<f64>) -> PairTerms {
    PairTerms {
        first: matrix.fixed_view::<3, 3>(0, 0).into_owned(),
        second: matrix.fixed_view::<3, 3>(3, 3).into_owned(),
        mixed: matrix.fixed_view::<3, 3>(0, 3).into_owned(),
        first_gradient: gradient.fixed_rows::<3>(0).into_owned(),
        second_gradient: gradient.fixed_rows::<3>(3).into_owned(),
    }
}

fn mixed_terms(mixed: Matrix3<f64>) -> PairTerms {
    PairTerms {
        first: Matrix3::zeros(),
        second: Matrix3::zeros(),
        mixed,
        first_gradient: Vector3::zeros(),
        second_gradient: Vector3::zeros(),
    }
}

#[cfg(test)]
#[path = "graph_tests.rs"]
mod tests;
