//! First poses, from the edges alone.

use nalgebra::{Matrix3, Vector3};

use super::block_system::{BlockSystem, PairTerms, Unsolvable};
use super::graph::Graph;
use crate::se2::Se2;

/// Poses by following the edges from pose 0: each pose by the first edge that reaches it, those of the sequence
/// (i to i + 1) before all others. Poses that no edge reaches stay at the origin.
#[must_use]
pub fn chain_start(graph: &Graph) -> Vec<Se2> {
    let count = graph.poses.len();
    let mut neighbours: Vec<Vec<(usize, Se2)>> = vec![Vec::new(); count];
    for edge in &graph.edges {
        if edge.from < count && edge.to < count {
            neighbours[edge.from].push((edge.to, edge.measured));
            neighbours[edge.to].push((edge.from, edge.measured.inverse()));
        }
    }
    let mut poses: Vec<Option<Se2>> = vec![None; count];
    // The sequence is followed to its end before any loop: those wait in the second queue.
    let mut sequence = vec![0_usize];
    let mut loops: std::collections::VecDeque<(usize, Se2)> = std::collections::VecDeque::new();
    if let (Some(first), Some(pose)) = (poses.first_mut(), graph.poses.first()) {
        *first = Some(*pose);
    }
    loop {
        let here = match sequence.pop() {
            Some(here) => here,
            None => match loops.pop_front() {
                Some((there, pose)) if poses[there].is_none() => {
                    poses[there] = Some(pose);
                    there
                }
                Some(_) => continue,
                None => break,
            },
        };
        let Some(pose) = poses.get(here).copied().flatten() else { continue };
        for &(there, step) in &neighbours[here] {
            if poses[there].is_some() {
                continue;
            }
            if there.abs_diff(here) == 1 {
                poses[there] = Some(pose.compose(step));
                sequence.push(there);
            } else {
                loops.push_back((there, pose.compose(step)));
            }
        }
    }
    poses.into_iter().map(Option::unwrap_or_default).collect()
}

/// Poses in two linear steps: first the headings, as directions in the plane whose length is free, then the places for
/// these headings (chordal relaxation: Martinec and Pajdla 2007; Carlone et al. 2015, section III). Needs no first guess.
///
/// # Errors
/// A part of the graph hangs on nothing.
pub fn orientation_start(graph: &Graph, weights: &[f64]) -> Result<Vec<Se2>, Unsolvable> {
    let count = graph.poses.len();
    let mut system = BlockSystem::new(count, &graph.pairs());
    let weight = |index: usize| weights.get(index).copied().unwrap_or(1.0);
    // Directions: second = turned first. The third number of a block is not used.
    let first_pose = graph.poses.first().copied().unwrap_or_default();
    let (sin, cos) = first_pose.heading_rad.sin_cos();
    system.clear();
    for (index, edge) in graph.edges.iter().enumerate() {
        let (s, c) = edge.measured.heading_rad.sin_cos();
        let turn = Matrix3::new(c, -s, 0.0, s, c, 0.0, 0.0, 0.0, 1.0);
        let strength = weight(index) * edge.information[(2, 2)];
        let mut error = Vector3::zeros();
        if edge.from == 0 {
            error -= turn * Vector3::new(cos, sin, 0.0);
        }
        if edge.to == 0 {
            error += Vector3::new(cos, sin, 0.0);
        }
        system.add(index, &linear_terms(&-turn, &error, strength));
    }
    let step = system.solve()?;
    let mut poses = vec![first_pose; count];
    for (pose, step) in poses.iter_mut().skip(1).zip(step.chunks_exact(3)) {
        *pose = Se2::new(0.0, 0.0, step[1].atan2(step[0]));
    }
    places(&mut system, graph, &mut poses, weights)?;
    Ok(poses)
}

/// Places for given headings: linear.
fn places(
    system: &mut BlockSystem,
    graph: &Graph,
    poses: &mut [Se2],
    weights: &[f64],
) -> Result<(), Unsolvable> {
    system.clear();
    for (index, edge) in graph.edges.iter().enumerate() {
        let (Some(from), Some(to)) = (poses.get(edge.from), poses.get(edge.to)) else { continue };
        let weight = weights.get(index).copied().unwrap_or(1.0);
        let mut terms = edge.terms(*from, *to, weight);
        // Headings are held: their rows and columns become the identity.
        for block in [&mut terms.first, &mut terms.second, &mut terms.mixed] {
            for axis in 0..3 {
                block[(axis, 2)] = 0.0;
                block[(2, axis)] = 0.0;
            }
        }
        terms.first[(2, 2)] = 1.0;
        terms.second[(2, 2)] = 1.0;
        terms.first_gradient.z = 0.0;
        terms.second_gradient.z = 0.0;
        system.add(index, &terms);
    }
    let step = system.solve()?;
    for (pose, step) in poses.iter_mut().skip(1).zip(step.chunks_exact(3)) {
        *pose = Se2::new(pose.x_m + step[0], pose.y_m + step[1], pose.heading_rad);
    }
    Ok(())
}

/// The error second − turned first, linear in both.
fn linear_terms(first: &Matrix3<f64>, error: &Vector3<f64>, strength: f64) -> PairTerms {
    PairTerms {
        first: first.transpose() * first * strength,
        second: Matrix3::identity() * strength,
        mixed: first.transpose() * strength,
        first_gradient: first.transpose() * error * strength,
        second_gradient: error * strength,
    }
}
