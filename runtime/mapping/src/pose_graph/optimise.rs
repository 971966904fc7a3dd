//! The poses of the least squared error: Gauss-Newton where it goes down, damped where it does not.

use super::block_system::{BlockSystem, Unsolvable};
use super::graph::Graph;

/// When to stop.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct OptimiseConfig {
    /// Steps at most.
    pub steps_max: usize,
    /// A step that lowers the error by a smaller share ends it.
    pub share_least: f64,
}

impl Default for OptimiseConfig {
    fn default() -> Self {
        Self { steps_max: 100, share_least: 1.0e-9 }
    }
}

/// How an optimisation went.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Optimised {
    /// Sum of the weighed squared errors.
    pub chi2: f64,
    /// Steps taken.
    pub steps: usize,
    /// The last step gained less than asked for; otherwise the steps were used up.
    pub has_converged: bool,
}

/// Moves the poses to the least sum of weighed squared errors. `weights` scale the edges' information, by index; a missing
/// one counts 1.
///
/// # Errors
/// A part of the graph hangs on nothing.
pub fn optimise(
    graph: &mut Graph,
    weights: &[f64],
    config: &OptimiseConfig,
) -> Result<Optimised, Unsolvable> {
    let mut system = BlockSystem::new(graph.poses.len(), &graph.pairs());
    Ok(optimise_with(&mut system, graph, weights, config))
}

/// The same with equations that were analysed before.
pub(super) fn optimise_with(
    system: &mut BlockSystem,
    graph: &mut Graph,
    weights: &[f64],
    config: &OptimiseConfig,
) -> Optimised {
    let mut descent = Descent::new(graph, weights);
    loop {
        if let Some(optimised) = descent.step((system, graph), weights, config) {
            return optimised;
        }
    }
}

/// An optimisation between two steps.
pub(super) struct Descent {
    chi2: f64,
    damping: f64,
    steps: usize,
}

impl Descent {
    /// Before the first step.
    pub(super) fn new(graph: &Graph, weights: &[f64]) -> Self {
        Self { chi2: weighed_chi2(graph, weights), damping: 0.0, steps: 0 }
    }

    /// Takes a step; answers when it was the last one.
    pub(super) fn step(
        &mut self,
        (system, graph): (&mut BlockSystem, &mut Graph),
        weights: &[f64],
        config: &OptimiseConfig,
    ) -> Option<Optimised> {
        if self.steps >= config.steps_max {
            return Some(self.ended(false));
        }
        self.steps += 1;
        linearise(system, graph, weights);
        if self.damping > 0.0 {
            system.damp(self.damping);
        }
        let before = graph.poses.clone();
        let mut after = self.chi2;
        let lowered = system.solve().is_ok_and(|step| {
            graph.poses = graph.moved(&step);
            after = weighed_chi2(graph, weights);
            after <= self.chi2
        });
        if !lowered {
            graph.poses = before;
            self.damping = if self.damping == 0.0 { 1.0e-6 } else { self.damping * 10.0 };
            return (self.damping > 1.0e12).then(|| self.ended(true));
        }
        self.damping = if self.damping < 1.0e-8 { 0.0 } else { self.damping * 0.1 };
        let gain = self.chi2 - after;
        self.chi2 = after;
        if gain <= config.share_least * self.chi2.max(1.0e-12) {
            return Some(self.ended(true));
        }
        (self.steps >= config.steps_max).then(|| self.ended(false))
    }

    const fn ended(&self, has_converged: bool) -> Optimised {
        Optimised { chi2: self.chi2, steps: self.steps, has_converged }
    }
}

fn weighed_chi2(graph: &Graph, weights: &[f64]) -> f64 {
    let weight = |index: usize| weights.get(index).copied().unwrap_or(1.0);
    graph.edges.iter().enumerate().map(|(index, edge)| weight(index) * graph.edge_chi2(edge)).sum()
}

pub(super) fn linearise(system: &mut BlockSystem, graph: &Graph, weights: &[f64]) {
    system.clear();
    for (index, edge) in graph.edges.iter().enumerate() {
        let (Some(from), Some(to)) = (graph.poses.get(edge.from), graph.poses.get(edge.to)) else { continue };
        let weight = weights.get(index).copied().unwrap_or(1.0);
        system.add(index, &edge.terms(*from, *to, weight));
    }
}
