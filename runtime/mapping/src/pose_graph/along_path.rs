//! Poses from the edges alone, with wrong loops among them: along the path, each loop is judged when the path has just
//! reached it, by poses that the loops before have corrected. What one stretch of odometry drifts is little; what a whole
//! building's odometry drifts is more than most wrong loops are off.

use nalgebra::Matrix3;

use super::block_system::{BlockSystem, Unsolvable};
use super::edge::{Edge, EdgeKind};
use super::graph::Graph;
use super::optimise::{OptimiseConfig, linearise, optimise_with};
use super::robust::{RobustConfig, RobustOutcome, optimise_robustly};
use super::start::chain_start;
use crate::se2::Se2;

/// Poses that the path grows by before loops are judged, or a fiftieth of it.
const PATH_STEP: usize = 25;
/// Rounds in which loops may join on one stretch of the path.
const JOIN_ROUNDS: usize = 4;

/// Moves the poses to the least error of the edges that agree; the poses' first values do not count.
///
/// A loop joins if its error against the poses so far is one that their doubt and its own explain (the test of Mahalanobis
/// that filters gate by); those left out are asked again as the path grows.
///
/// # Errors
/// A part of the graph hangs on nothing.
pub fn optimise_along_path(graph: &mut Graph, config: &RobustConfig) -> Result<RobustOutcome, Unsolvable> {
    let count = graph.poses.len();
    let chained = chain_start(graph);
    let mut weights: Vec<f64> =
        graph.edges.iter().map(|edge| f64::from(u8::from(edge.kind == EdgeKind::Sequence))).collect();
    let mut poses: Vec<Se2> = chained.iter().take(1).copied().collect();
    while poses.len() < count {
        let known = poses.len();
        let end = (known + (known / 50).max(PATH_STEP)).min(count);
        for index in known..end {
            let step = chained[index - 1].between(chained[index]);
            poses.push(poses[index - 1].compose(step));
        }
        let inside: Vec<usize> =
            (0..graph.edges.len()).filter(|&i| graph.edges[i].from < end && graph.edges[i].to < end).collect();
        let mut part = Graph { poses, edges: inside.iter().map(|&i| graph.edges[i]).collect() };
        let mut part_weights: Vec<f64> = inside.iter().map(|&i| weights[i]).collect();
        join(&mut part, &mut part_weights, known, config)?;
        for (&index, weight) in inside.iter().zip(&part_weights) {
            weights[index] = *weight;
        }
        poses = part.poses;
    }
    graph.poses = poses;
    join(graph, &mut weights, 0, config)?;
    let decided: Vec<Option<f64>> = weights.into_iter().map(Some).collect();
    optimise_robustly(graph, &decided, config)
}

/// Lets the loops join that end at pose `from` or later.
fn join(graph: &mut Graph, weights: &mut [f64], from: usize, config: &RobustConfig) -> Result<(), Unsolvable> {
    let asked = |edge: &Edge| edge.kind == EdgeKind::Loop && edge.from.max(edge.to) >= from;
    if !graph.edges.iter().any(asked) {
        return Ok(());
    }
    let mut system = BlockSystem::new(graph.poses.len(), &graph.pairs())?;
    let round = OptimiseConfig { steps_max: 4, share_least: 1.0e-4 };
    for _ in 0..JOIN_ROUNDS {
        linearise(&mut system, graph, weights);
        system.solve()?;
        let mut joined = 0;
        for index in 0..graph.edges.len() {
            let edge = graph.edges[index];
            if weights[index] == 0.0 && asked(&edge) && is_explained(&mut system, graph, &edge, config.chi2_limit) {
                weights[index] = 1.0;
                joined += 1;
            }
        }
        if joined == 0 {
            break;
        }
        optimise_with(&mut system, graph, weights, &round)?;
        for (edge, weight) in graph.edges.iter().zip(weights.iter_mut()) {
            if edge.kind == EdgeKind::Loop && graph.edge_chi2(edge) > config.chi2_limit {
                *weight = 0.0;
            }
        }
        optimise_with(&mut system, graph, weights, &round)?;
    }
    Ok(())
}

/// Whether the doubt of the poses and of the edge explains its error.
fn is_explained(system: &mut BlockSystem, graph: &Graph, edge: &Edge, limit: f64) -> bool {
    let (from, to) = (graph.poses[edge.from], graph.poses[edge.to]);
    let error = edge.error(from, to);
    if error.dot(&(edge.information * error)) <= limit {
        return true;
    }
    let spread = system.spread([edge.from, edge.to], &edge.derivatives(from, to));
    let own = edge.information.try_inverse().unwrap_or(Matrix3::zeros());
    let Some(factor) = (spread + own).cholesky() else { return false };
    error.dot(&factor.solve(&error)) <= limit
}
