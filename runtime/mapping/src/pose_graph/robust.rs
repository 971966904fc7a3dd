//! Optimisation that wrong loops cannot bend: graduated non-convexity with a truncated square (Yang et al. 2020, section
//! V.B). A loop counts fully, or not at all; the decision is made softly first.

use super::block_system::{BlockSystem, Unsolvable};
use super::edge::{Edge, EdgeKind};
use super::graph::Graph;
use super::optimise::{OptimiseConfig, Optimised, optimise_with};

/// Settings of the robust optimisation.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RobustConfig {
    /// Weighed squared error from which a loop is wrong. 16.27: a right one of three dimensions is beyond once in a
    /// thousand times.
    pub chi2_limit: f64,
    /// Growth of the control from round to round.
    pub growth: f64,
    /// Rounds at most.
    pub rounds_max: usize,
    /// Each round's optimisation.
    pub round: OptimiseConfig,
    /// The last one, with the loops that are left.
    pub last: OptimiseConfig,
}

impl Default for RobustConfig {
    fn default() -> Self {
        Self {
            chi2_limit: 16.27,
            growth: 1.4,
            rounds_max: 60,
            round: OptimiseConfig { steps_max: 3, share_least: 1.0e-3 },
            last: OptimiseConfig::default(),
        }
    }
}

/// How it went.
#[derive(Clone, Debug, PartialEq)]
pub struct RobustOutcome {
    /// The last optimisation, without the loops that are not believed.
    pub optimised: Optimised,
    /// Weight of each edge, 0 to 1.
    pub weights: Vec<f64>,
    /// Rounds needed.
    pub rounds: usize,
}

/// Moves the poses to the least error of the edges that agree, beginning at the poses as they are. Edges of the sequence
/// always count; loops of which `decided` holds a weight are not doubted again, but dropped or taken back at the end.
///
/// # Errors
/// A part of the graph hangs on nothing.
pub fn optimise_robustly(
    graph: &mut Graph,
    decided: &[Option<f64>],
    config: &RobustConfig,
) -> Result<RobustOutcome, Unsolvable> {
    let mut system = BlockSystem::new(graph.poses.len(), &graph.pairs())?;
    let is_loop = |edge: &Edge| edge.kind == EdgeKind::Loop;
    let decided = |index: usize| decided.get(index).copied().flatten();
    let doubted: Vec<usize> =
        (0..graph.edges.len()).filter(|&i| is_loop(&graph.edges[i]) && decided(i).is_none()).collect();
    let mut weights: Vec<f64> = (0..graph.edges.len()).map(|index| decided(index).unwrap_or(1.0)).collect();
    let rounds = graduate(&mut system, graph, (&doubted, &mut weights), config)?;
    for _ in 0..JOIN_ROUNDS {
        let before = weights.clone();
        for (edge, weight) in graph.edges.iter().zip(&mut weights) {
            if is_loop(edge) {
                *weight = f64::from(u8::from(graph.edge_chi2(edge) <= config.chi2_limit));
            }
        }
        if before == weights {
            break;
        }
        optimise_with(&mut system, graph, &weights, &config.round)?;
    }
    let optimised = optimise_with(&mut system, graph, &weights, &config.last)?;
    Ok(RobustOutcome { optimised, weights, rounds })
}

/// Rounds in which loops may join or leave after the graduation.
const JOIN_ROUNDS: usize = 12;

/// The graduation over the doubted edges; answers the rounds.
fn graduate(
    system: &mut BlockSystem,
    graph: &mut Graph,
    (doubted, weights): (&[usize], &mut Vec<f64>),
    config: &RobustConfig,
) -> Result<usize, Unsolvable> {
    let limit = config.chi2_limit;
    let worst = |graph: &Graph| {
        doubted.iter().map(|&index| graph.edge_chi2(&graph.edges[index])).fold(0.0, f64::max)
    };
    let at_start = worst(graph);
    if at_start <= limit {
        return Ok(0);
    }
    let mut control = limit / (2.0 * at_start - limit);
    for round in 1..=config.rounds_max {
        let mut undecided = 0;
        for &index in doubted {
            let weight = truncated_weight(graph.edge_chi2(&graph.edges[index]), limit, control);
            undecided += usize::from(weight > 1.0e-3 && weight < 0.999);
            weights[index] = weight;
        }
        if undecided == 0 && round > 1 {
            return Ok(round);
        }
        optimise_with(system, graph, weights, &config.round)?;
        control *= config.growth;
    }
    Ok(config.rounds_max)
}

/// Weight of a squared error under the truncated square at a stage of the control (Yang et al. 2020, equation 14).
fn truncated_weight(chi2: f64, limit: f64, control: f64) -> f64 {
    let upper = (control + 1.0) / control * limit;
    let lower = control / (control + 1.0) * limit;
    if chi2 >= upper {
        0.0
    } else if chi2 <= lower {
        1.0
    } else {
        (limit / chi2 * control * (control + 1.0)).sqrt() - control
    }
}
