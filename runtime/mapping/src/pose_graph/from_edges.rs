//! The most likely poses from the edges alone, with wrong loops among them: loops that support each other give the first
//! poses; from there every loop is judged.

use super::block_system::{BlockSystem, Unsolvable};
use super::edge::{Edge, EdgeKind};
use super::graph::Graph;
use super::optimise::{linearise, optimise_with};
use super::robust::{RobustConfig, RobustOutcome, optimise_robustly};
use super::start::{chain_start, orientation_start};
use super::supported::support;

/// Rounds in which loops may join or leave.
const ROUNDS_MAX: usize = 20;
/// Rounds in which loops that bend the graph are taken out.
const BENDING_ROUNDS_MAX: usize = 20;
/// Support that is asked for at most.
const SUPPORT_MOST: u32 = 4;
/// Share of the supported loops that must have it.
const SUPPORTED_SHARE: f64 = 0.7;
/// Loops with more support than this are not asked whether they bend the graph.
const SUPPORT_LITTLE: u32 = 2;
/// Share of its own covariance below which nothing checks an edge.
const CHECKED_LEAST: f64 = 1.0e-3;

/// Moves the poses to the least error of the edges that agree; where the poses stood before does not count. Edges of the
/// sequence always count.
///
/// # Errors
/// A part of the graph hangs on nothing.
pub fn optimise_from_edges(graph: &mut Graph, config: &RobustConfig) -> Result<RobustOutcome, Unsolvable> {
    let support = support(graph);
    let needed = support_needed(&support);
    let is_kept = |index: usize| graph.edges[index].kind == EdgeKind::Sequence || support[index] >= needed;
    let kept: Vec<usize> = (0..graph.edges.len()).filter(|index| is_kept(*index)).collect();
    let mut part =
        Graph { poses: graph.poses.clone(), edges: kept.iter().map(|i| graph.edges[*i]).collect() };
    part.poses = chain_start(&part);
    part.poses = orientation_start(&part, &[])?;
    let first = optimise_robustly(&mut part, config)?;
    graph.poses = part.poses;
    let mut weights = vec![0.0; graph.edges.len()];
    for (index, weight) in kept.iter().zip(first.weights) {
        weights[*index] = weight;
    }
    let mut system = BlockSystem::new(graph.poses.len(), &graph.pairs());
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
        optimise_with(&mut system, graph, &weights, &config.round);
    }
    rounds += remove_bending(&mut system, graph, (&mut weights, &support), config)?;
    let optimised = optimise_with(&mut system, graph, &weights, &config.last);
    Ok(RobustOutcome { optimised, weights, rounds })
}

/// Support that the first loops must have: as much as most of the supported ones have. Where loops are many, wrong ones
/// find company by accident.
fn support_needed(support: &[u32]) -> u32 {
    let with = |least: u32| support.iter().filter(|count| **count >= least).count() as f64;
    let enough = |least: &u32| with(*least) >= SUPPORTED_SHARE * with(1);
    (2..=SUPPORT_MOST).rev().find(enough).unwrap_or(1)
}

/// Takes out loops that fit only because they bend the others: a loop without much support is judged by its error against
/// what the error can be beside all others (Baarda 1968). The worst of each round goes with those that are half as bad.
/// Answers the rounds.
fn remove_bending(
    system: &mut BlockSystem,
    graph: &mut Graph,
    (weights, support): (&mut [f64], &[u32]),
    config: &RobustConfig,
) -> Result<usize, Unsolvable> {
    for round in 0..BENDING_ROUNDS_MAX {
        linearise(system, graph, weights);
        system.solve()?;
        let asked = (0..graph.edges.len()).filter(|index| {
            graph.edges[*index].kind == EdgeKind::Loop
                && weights[*index] > 0.5
                && support[*index] <= SUPPORT_LITTLE
        });
        let mut bending = Vec::new();
        for index in asked {
            let squared = standardised(system, graph, &graph.edges[index]);
            if squared > config.chi2_limit {
                bending.push((squared, index));
            }
        }
        let worst = bending.iter().map(|(squared, _)| *squared).fold(0.0, f64::max);
        if bending.is_empty() {
            return Ok(round);
        }
        bending
            .iter()
            .filter(|(squared, _)| *squared >= 0.5 * worst)
            .for_each(|(_, index)| weights[*index] = 0.0);
        optimise_with(system, graph, weights, &config.round);
    }
    Ok(BENDING_ROUNDS_MAX)
}

/// Squared error of a loop, weighed by what the other edges leave of its own covariance. An edge that nothing else
/// checks counts 0.
fn standardised(system: &BlockSystem, graph: &Graph, edge: &Edge) -> f64 {
    let (Some(from), Some(to)) = (graph.poses.get(edge.from), graph.poses.get(edge.to)) else { return 0.0 };
    let error = edge.error(*from, *to);
    let spread = system.spread([edge.from, edge.to], &edge.derivatives(*from, *to));
    let Some(own) = edge.information.try_inverse() else { return 0.0 };
    let left = own - spread + own * CHECKED_LEAST;
    left.cholesky().map_or(0.0, |factor| error.dot(&factor.solve(&error)))
}

#[cfg(test)]
#[path = "from_edges_tests.rs"]
mod tests;
