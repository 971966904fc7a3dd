//! Optimisation that wrong loops cannot bend: graduated non-convexity with a truncated square (Yang et al. 2020, section
//! V.B). A loop counts fully, or not at all; the decision is made softly first.

use super::block_system::{BlockSystem, Unsolvable};
use super::edge::EdgeKind;
use super::graph::Graph;
use super::optimise::{Descent, OptimiseConfig, Optimised};

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

/// Moves the poses to the least error of the edges that agree. Edges of the sequence always count.
///
/// # Errors
/// A part of the graph hangs on nothing.
pub fn optimise_robustly(graph: &mut Graph, config: &RobustConfig) -> Result<RobustOutcome, Unsolvable> {
    let mut descent = RobustDescent::new(std::mem::take(graph), *config);
    let outcome = loop {
        if let Some(outcome) = descent.step() {
            break outcome;
        }
    };
    *graph = descent.graph;
    Ok(outcome)
}

/// A robust optimisation between two steps: a robot that drives has no time for all of them at once.
pub struct RobustDescent {
    /// The graph as it is so far.
    pub graph: Graph,
    config: RobustConfig,
    system: BlockSystem,
    weights: Vec<f64>,
    control: f64,
    rounds: usize,
    undecided: usize,
    round: Option<Descent>,
    is_last: bool,
}

impl RobustDescent {
    /// Before the first step.
    #[must_use]
    pub fn new(graph: Graph, config: RobustConfig) -> Self {
        let system = BlockSystem::new(graph.poses.len(), &graph.pairs());
        let weights = vec![1.0; graph.edges.len()];
        let loops = graph.edges.iter().filter(|edge| edge.kind == EdgeKind::Loop);
        let worst = loops.map(|edge| graph.edge_chi2(edge)).fold(0.0, f64::max);
        let limit = config.chi2_limit;
        let control = if worst > limit { limit / (2.0 * worst - limit) } else { f64::INFINITY };
        Self { graph, config, system, weights, control, rounds: 0, undecided: 0, round: None, is_last: false }
    }

    /// Solves the equations once; answers when that was the last time. Cost: with the poses and the edges.
    pub fn step(&mut self) -> Option<RobustOutcome> {
        let mut descent = self.round.take().unwrap_or_else(|| self.next_round());
        let config = if self.is_last { &self.config.last } else { &self.config.round };
        let ended = descent.step((&mut self.system, &mut self.graph), &self.weights, config);
        let Some(optimised) = ended else {
            self.round = Some(descent);
            return None;
        };
        if !self.is_last {
            if self.undecided == 0 && self.rounds > 3 {
                self.control = f64::INFINITY;
            }
            self.control *= self.config.growth;
            return None;
        }
        let (weights, rounds) = (std::mem::take(&mut self.weights), self.rounds);
        Some(RobustOutcome { optimised, weights, rounds })
    }

    /// Judges the loops anew.
    fn next_round(&mut self) -> Descent {
        self.is_last = self.rounds >= self.config.rounds_max || !self.control.is_finite();
        self.rounds += usize::from(!self.is_last);
        let (limit, control, is_last) = (self.config.chi2_limit, self.control, self.is_last);
        self.undecided = 0;
        for (edge, weight) in self.graph.edges.iter().zip(&mut self.weights) {
            if edge.kind != EdgeKind::Loop {
                continue;
            }
            let chi2 = self.graph.edge_chi2(edge);
            *weight = match is_last {
                true => f64::from(u8::from(chi2 <= limit)),
                false => truncated_weight(chi2, limit, control),
            };
            self.undecided += usize::from(*weight > 0.0 && *weight < 0.999);
        }
        Descent::new(&self.graph, &self.weights)
    }
}

/// Weight of a squared error under the truncated square at a stage of the control (Yang et al. 2020, equation 14).
pub(super) fn truncated_weight(chi2: f64, limit: f64, control: f64) -> f64 {
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

#[cfg(test)]
mod tests {
    use nalgebra::Matrix3;

    use super::*;
    use crate::pose_graph::Edge;
    use crate::se2::Se2;

    /// A square of 40 m walked twice with an odometry that turns too far, and places that were recognised.
    #[test]
    fn first_loops_after_a_long_drift_are_believed() {
        let mut truth = vec![Se2::default()];
        let mut graph = Graph { poses: vec![Se2::default()], edges: Vec::new() };
        let sequence = Matrix3::from_diagonal(&[1.0e3, 1.0e3, 1.0e4].into());
        for step in 1..80_usize {
            let turn = if step % 10 == 0 { std::f64::consts::FRAC_PI_2 } else { 0.0 };
            let measured = Se2::new(1.0, 0.0, turn + 4.0e-3);
            truth.push(truth[step - 1].compose(Se2::new(1.0, 0.0, turn)));
            graph.poses.push(graph.poses[step - 1].compose(measured));
            let kind = EdgeKind::Sequence;
            graph.edges.push(Edge { from: step - 1, to: step, measured, information: sequence, kind });
        }
        let seen_again = |[from, to]: [usize; 2]| {
            let information = Matrix3::from_diagonal(&[1.0e6, 1.0e6, 1.0e6].into());
            let measured = truth[from].between(truth[to]);
            Edge { from, to, measured, information, kind: EdgeKind::Loop }
        };
        let mut wrong = seen_again([3, 40]);
        wrong.measured.x_m += 4.0;
        graph.edges.extend([[0, 40], [5, 45], [12, 52], [20, 60], [33, 73], [38, 78]].map(seen_again));
        graph.edges.push(wrong);
        let outcome = optimise_robustly(&mut graph, &RobustConfig::default()).unwrap();
        assert_eq!(outcome.weights[79..], [1.0, 1.0, 1.0, 1.0, 1.0, 1.0, 0.0]);
        let off = truth.iter().zip(&graph.poses).map(|(a, b)| a.distance(*b)).fold(0.0, f64::max);
        assert!(off < 0.3, "{off}");
    }
}
