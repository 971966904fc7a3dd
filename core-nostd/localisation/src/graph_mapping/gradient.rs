//! One step of Gauss-Newton by conjugate gradients: no matrix of the whole is made, so that memory grows with the scans alone.
//!
//! Hestenes and Stiefel 1952; the 3 × 3 blocks on the diagonal precondition.

use heapless::Vec;
use nalgebra::{Matrix3, Vector3};

use super::edges::{GraphEdge, Linearised};
use super::kept::{KeptScan, index};

/// Steps of the conjugate gradients at most.
const STEPS_MAX: usize = 80;
/// Share of the first residual at which they end.
const RESIDUAL_SHARE: f32 = 1.0e-4;
/// Added to each diagonal, so that a scan without a hold stays.
const DAMPING: f32 = 1.0e-3;

/// The poses as they are, and what is known about them.
pub(super) struct Problem<'a, const POINTS: usize> {
    pub(super) edges: &'a [GraphEdge],
    pub(super) scans: &'a [KeptScan<POINTS>],
    pub(super) trusted: f32,
}

/// Room of the conjugate gradients: 72 bytes a scan.
#[derive(Clone, Debug)]
pub(super) struct Gradient<const NODES: usize> {
    step: Vec<Vector3<f32>, NODES>,
    residual: Vec<Vector3<f32>, NODES>,
    direction: Vec<Vector3<f32>, NODES>,
    product: Vec<Vector3<f32>, NODES>,
    diagonal: Vec<[f32; 6], NODES>,
}

/// The inverse of a symmetric 3 × 3 matrix given by six numbers, times a vector.
fn preconditioned([xx, xy, xh, yy, yh, hh]: [f32; 6], vector: &Vector3<f32>) -> Vector3<f32> {
    let matrix = Matrix3::new(xx, xy, xh, xy, yy, yh, xh, yh, hh);
    matrix.cholesky().map_or_else(|| *vector, |factor| factor.solve(vector))
}

impl<const NODES: usize> Gradient<NODES> {
    pub(super) const fn new() -> Self {
        Self {
            step: Vec::new(),
            residual: Vec::new(),
            direction: Vec::new(),
            product: Vec::new(),
            diagonal: Vec::new(),
        }
    }

    /// The last step of each pose.
    pub(super) fn steps(&self) -> &[Vector3<f32>] {
        &self.step
    }

    /// Solves the normal equations of all poses, of which the first stays.
    pub(super) fn descend<const POINTS: usize>(&mut self, problem: &Problem<'_, POINTS>) {
        self.begin(problem);
        let mut along = self.precondition();
        let enough = along * RESIDUAL_SHARE * RESIDUAL_SHARE;
        for _ in 0..STEPS_MAX {
            // Also false for a NaN.
            let goes_on = along > enough && along > 0.0;
            if !goes_on {
                break;
            }
            self.multiply(problem);
            let bent = dot(&self.direction, &self.product);
            let length = if bent > 0.0 { along / bent } else { break };
            add(&mut self.step, &self.direction, length);
            add(&mut self.residual, &self.product, -length);
            let next = self.precondition_into_product();
            let share = next / along;
            for (direction, better) in self.direction.iter_mut().zip(&self.product) {
                *direction = *better + *direction * share;
            }
            along = next;
        }
    }

    /// Right side, diagonal blocks and no step yet.
    fn begin<const POINTS: usize>(&mut self, problem: &Problem<'_, POINTS>) {
        let count = problem.scans.len().min(NODES);
        for vector in [&mut self.step, &mut self.residual, &mut self.direction, &mut self.product] {
            vector.clear();
            // the capacity is that of the scans.
            let _ = vector.resize(count, Vector3::zeros());
        }
        self.diagonal.clear();
        let _ = self.diagonal.resize(count, [DAMPING, 0.0, 0.0, DAMPING, 0.0, DAMPING]);
        for edge in problem.edges {
            let Some((at, information)) = problem.weighed(edge) else { continue };
            let pull = information * at.error;
            for (number, by) in [(edge.from, &at.by_from), (edge.to, &at.by_to)] {
                let block = by.transpose() * information * by;
                if let Some(residual) = self.residual.get_mut(index(number)) {
                    *residual -= by.transpose() * pull;
                }
                if let Some(diagonal) = self.diagonal.get_mut(index(number)) {
                    let [[xx, xy, xh], [_, yy, yh], [_, _, hh]] = block.transpose().data.0;
                    let more = [xx, xy, xh, yy, yh, hh];
                    diagonal.iter_mut().zip(more).for_each(|(value, more)| *value += more);
                }
            }
        }
        if let Some(first) = self.residual.first_mut() {
            *first = Vector3::zeros();
        }
    }

    /// The first direction; its product with the residual.
    fn precondition(&mut self) -> f32 {
        let rows = self.residual.iter().zip(&self.diagonal);
        for (direction, (residual, diagonal)) in self.direction.iter_mut().zip(rows) {
            *direction = preconditioned(*diagonal, residual);
        }
        dot(&self.residual, &self.direction)
    }

    fn precondition_into_product(&mut self) -> f32 {
        let rows = self.residual.iter().zip(&self.diagonal);
        for (product, (residual, diagonal)) in self.product.iter_mut().zip(rows) {
            *product = preconditioned(*diagonal, residual);
        }
        dot(&self.residual, &self.product)
    }

    /// The normal matrix times the direction.
    fn multiply<const POINTS: usize>(&mut self, problem: &Problem<'_, POINTS>) {
        for (product, direction) in self.product.iter_mut().zip(&self.direction) {
            *product = *direction * DAMPING;
        }
        for edge in problem.edges {
            let Some((at, information)) = problem.weighed(edge) else { continue };
            let part = |number: u16| self.direction.get(index(number)).copied().unwrap_or_default();
            let pull = information * (at.by_from * part(edge.from) + at.by_to * part(edge.to));
            for (number, by) in [(edge.from, &at.by_from), (edge.to, &at.by_to)] {
                if let Some(product) = self.product.get_mut(index(number)) {
                    *product += by.transpose() * pull;
                }
            }
        }
        if let Some(first) = self.product.first_mut() {
            *first = Vector3::zeros();
        }
    }
}

impl<const POINTS: usize> Problem<'_, POINTS> {
    /// An edge at the poses as they are, and its inverse covariance with the weight of a loop (Agarwal et al. 2013, equation 15).
    fn weighed(&self, edge: &GraphEdge) -> Option<(Linearised, Matrix3<f32>)> {
        let pose = |number: u16| self.scans.get(index(number)).map(|scan| scan.pose);
        let at = edge.linearised(pose(edge.from)?, pose(edge.to)?);
        let information = edge.matrix();
        if edge.is_step {
            return Some((at, information));
        }
        let squared = (at.error.transpose() * information * at.error).x;
        let scale = (2.0 * self.trusted / (self.trusted + squared)).min(1.0);
        Some((at, information * (scale * scale)))
    }
}

fn dot(a: &[Vector3<f32>], b: &[Vector3<f32>]) -> f32 {
    a.iter().zip(b).map(|(a, b)| a.dot(b)).sum()
}

fn add(to: &mut [Vector3<f32>], more: &[Vector3<f32>], share: f32) {
    to.iter_mut().zip(more).for_each(|(to, more)| *to += more * share);
}
