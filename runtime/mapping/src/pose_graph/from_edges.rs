//! The most likely poses from the edges alone, with wrong loops among them: loops that support each other give the first
//! poses; from there every loop is judged.

use super::block_system::{BlockSystem, Unsolvable};
use super::edge::EdgeKind;
use super::graph::Graph;
use super::optimise::optimise_with;
use super::robust::{RobustConfig, RobustOutcome, optimise_robustly};
use super::start::{chain_start, orientation_start};
use super::supported::support;

/// Rounds in which loops may join or leave.
const ROUNDS_MAX: usize = 20;

/// Moves the poses to the least error of the edges that agree; where the poses stood before does not count. Edges of the
/// sequence always count.
///
/// # Errors
/// A part of the graph hangs on nothing.
pub fn optimise_from_edges(graph: &mut Graph, config: &RobustConfig) -> Result<RobustOutcome, Unsolvable> {
    let support = support(graph);
    let is_kept = |index: usize| graph.edges[index].kind == EdgeKind::Sequence || support[index] > 0;
    let kept: Vec<usize> = (0..graph.edges.len()).filter(|index| is_kept(*index)).collect();
    let mut part = Graph { poses: graph.poses.clone(), edges: kept.iter().map(|i| graph.edges[*i]).collect() };
    part.poses = chain_start(&part);
    part.poses = orientation_start(&part, &[])?;
    let first = optimise_robustly(&mut part, config)?;
    graph.poses = part.poses;
    let mut weights = vec![0.0; graph.edges.len()];
    for (index, weight) in kept.iter().zip(first.weights) {
        weights[*index] = weight;
    }
    let mut system = BlockSystem::new(graph.poses.len(), &graph.pairs())?;
    let mut rounds = first.rounds;
    for _ in 0..ROUNDS_MAX {
        let before = weights.clone();
        for (edge, weight) in graph.edges.iter().zip(&mut weights) {
            if edge.kind == EdgeKind::Loop {
                *weight = f64::from(u8::from(graph.edge_chi2(edge) <= config.chi2_limit));
            }
        }
        if weights == before {
            break;
        }
        rounds += 1;
        optimise_with(&mut system, graph, &weights, &config.round)?;
    }
    let optimised = optimise_with(&mut system, graph, &weights, &config.last)?;
    Ok(RobustOutcome { optimised, weights, rounds })
}
