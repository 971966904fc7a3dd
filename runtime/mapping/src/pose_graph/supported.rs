//! Loops that another loop supports: two loops that begin near each other on the path and end near each other must agree
//! by the little odometry between them. A wrong loop seldom has company (Latif et al. 2013; Mangelson et al. 2018).

use std::collections::BTreeMap;

use super::edge::{Edge, EdgeKind};
use super::graph::Graph;
use super::uncertain::UncertainPose;

/// Poses between the beginnings, and between the ends, of two loops that are compared, at most.
const NEAR_POSES: usize = 20;
/// Loops with which one is compared at most.
const COMPARED_MAX: usize = 24;
/// Weighed squared disagreement of two loops that support each other: right ones are beyond once in a hundred times.
const SUPPORT_CHI2: f64 = 11.34;

/// A loop from the earlier pose to the later one.
struct Span {
    edge: usize,
    from: usize,
    to: usize,
    measured: UncertainPose,
}

/// For each edge: how many loops support it. Edges of the sequence have 0. Cost: for each pair of loops that are near each
/// other at both ends, the poses between them.
#[must_use]
pub fn support(graph: &Graph) -> Vec<u32> {
    let steps = steps(graph);
    let mut spans: Vec<Span> = graph.edges.iter().enumerate().filter_map(span).collect();
    spans.sort_by_key(|span| (span.from, span.to));
    let mut counts = vec![0_u32; graph.edges.len()];
    for (index, first) in spans.iter().enumerate() {
        let near = spans[index + 1..].iter().take_while(|second| second.from - first.from <= NEAR_POSES);
        let near = near.filter(|second| second.to.abs_diff(first.to) <= NEAR_POSES);
        for second in near.take(COMPARED_MAX) {
            if agree(first, second, &steps) {
                counts[first.edge] += 1;
                counts[second.edge] += 1;
            }
        }
    }
    counts
}

/// The step from each pose to the next, by its number.
fn steps(graph: &Graph) -> BTreeMap<usize, UncertainPose> {
    let mut steps = BTreeMap::new();
    for edge in graph.edges.iter().filter(|edge| edge.kind == EdgeKind::Sequence) {
        let Some(measured) = UncertainPose::of(edge) else { continue };
        if edge.from + 1 == edge.to {
            steps.insert(edge.from, measured);
        } else if edge.to + 1 == edge.from {
            steps.insert(edge.to, measured.inverse());
        }
    }
    steps
}

fn span((index, edge): (usize, &Edge)) -> Option<Span> {
    if edge.kind != EdgeKind::Loop {
        return None;
    }
    let measured = UncertainPose::of(edge)?;
    Some(if edge.from <= edge.to {
        Span { edge: index, from: edge.from, to: edge.to, measured }
    } else {
        Span { edge: index, from: edge.to, to: edge.from, measured: measured.inverse() }
    })
}

/// Along the path from one pose to another; `None` over a gap.
fn along(steps: &BTreeMap<usize, UncertainPose>, from: usize, to: usize) -> Option<UncertainPose> {
    let mut way = UncertainPose::identity();
    for pose in from.min(to)..from.max(to) {
        way = way.compose(*steps.get(&pose)?);
    }
    Some(if from <= to { way } else { way.inverse() })
}

fn agree(first: &Span, second: &Span, steps: &BTreeMap<usize, UncertainPose>) -> bool {
    let ends = along(steps, first.from, second.from).zip(along(steps, second.to, first.to));
    ends.is_some_and(|(before, after)| {
        let detour = before.compose(second.measured).compose(after);
        detour.squared_difference(first.measured) <= SUPPORT_CHI2
    })
}
