//! Solutions with a factor.

use nalgebra::{Matrix3, Vector3};

use super::BLOCK;
use super::analysis::Front;
use super::factor::Factor;

impl Factor {
    /// Solves the equations for a right side, three numbers for each variable, in its place. Cost: two multiplications
    /// for each number of the factor.
    pub(in crate::pose_graph) fn solve(&self, side: &mut [f64]) {
        let mut ordered = vec![0.0; side.len()];
        for (part, position) in side.chunks_exact(BLOCK).zip(&self.analysis.positions) {
            ordered[BLOCK * position..BLOCK * (position + 1)].copy_from_slice(part);
        }
        let mut local = Vec::new();
        for front in &self.analysis.fronts {
            gather(front, &ordered, &mut local);
            self.forward(front, &mut local);
            scatter(front, &local, &mut ordered);
        }
        for front in self.analysis.fronts.iter().rev() {
            gather(front, &ordered, &mut local);
            self.backward(front, &mut local);
            let start = BLOCK * front.first;
            ordered[start..start + front.pivots].copy_from_slice(&local[..front.pivots]);
        }
        for (part, position) in side.chunks_exact_mut(BLOCK).zip(&self.analysis.positions) {
            part.copy_from_slice(&ordered[BLOCK * position..BLOCK * (position + 1)]);
        }
    }

    fn columns(&self, front: &Front) -> impl DoubleEndedIterator<Item = &[f64]> + ExactSizeIterator {
        self.values[front.start..front.start + front.height * front.pivots].chunks_exact(front.height)
    }

    fn forward(&self, front: &Front, local: &mut [f64]) {
        for (index, column) in self.columns(front).enumerate() {
            let value = local[index] / column[index];
            local[index] = value;
            for (other, factor) in local[index + 1..].iter_mut().zip(&column[index + 1..]) {
                *other -= factor * value;
            }
        }
    }

    fn backward(&self, front: &Front, local: &mut [f64]) {
        for (index, column) in self.columns(front).enumerate().rev() {
            let sum = product(&column[index + 1..front.size], &local[index + 1..front.size]);
            local[index] = (local[index] - sum) / column[index];
        }
    }

    /// Jᵀ H⁻¹ J for a narrow J that has blocks at a few variables only. Cost: the fronts from these to the roots.
    pub(in crate::pose_graph) fn quadratic(&self, parts: &[(usize, Matrix3<f64>)]) -> Matrix3<f64> {
        let count = self.analysis.positions.len();
        let mut sides = [(); BLOCK].map(|()| vec![0.0; BLOCK * count]);
        let mut due: Vec<usize> = Vec::new();
        for (variable, part) in parts {
            let position = self.analysis.positions[*variable];
            due.push(self.analysis.front_of[position]);
            for (axis, side) in sides.iter_mut().enumerate() {
                let target = &mut side[BLOCK * position..BLOCK * (position + 1)];
                target.iter_mut().zip(part.column(axis).iter()).for_each(|(value, from)| *value += from);
            }
        }
        let mut sum = Matrix3::zeros();
        let mut local = Vec::new();
        // A parent comes after its children: the smallest front that is due has all it needs.
        while let Some(index) = due.iter().min().copied() {
            let front = &self.analysis.fronts[index];
            due.retain(|other| *other != index);
            due.extend(front.parent);
            let mut solved = [(); BLOCK].map(|()| Vec::new());
            for (side, solved) in sides.iter_mut().zip(&mut solved) {
                gather(front, side, &mut local);
                self.forward(front, &mut local);
                scatter(front, &local, side);
                solved.extend_from_slice(&local[..front.pivots]);
            }
            let [x, y, z] = &solved;
            for ((x, y), z) in x.iter().zip(y).zip(z) {
                let values = Vector3::new(*x, *y, *z);
                sum += values * values.transpose();
            }
        }
        sum
    }
}

/// The numbers of a front's rows; zeros in the filling.
fn gather(front: &Front, side: &[f64], local: &mut Vec<f64>) {
    local.clear();
    let start = BLOCK * front.first;
    local.extend_from_slice(&side[start..start + front.pivots]);
    for row in &front.below {
        local.extend_from_slice(&side[BLOCK * row..BLOCK * (row + 1)]);
    }
    local.resize(front.height, 0.0);
}

fn scatter(front: &Front, local: &[f64], side: &mut [f64]) {
    let start = BLOCK * front.first;
    side[start..start + front.pivots].copy_from_slice(&local[..front.pivots]);
    for (row, part) in front.below.iter().zip(local[front.pivots..].chunks_exact(BLOCK)) {
        side[BLOCK * row..BLOCK * (row + 1)].copy_from_slice(part);
    }
}

/// Sum of the products, in four sums side by side.
fn product(first: &[f64], second: &[f64]) -> f64 {
    let (first, first_rest) = first.as_chunks::<4>();
    let (second, second_rest) = second.as_chunks::<4>();
    let mut sums = [0.0; 4];
    for (a, b) in first.iter().zip(second) {
        for ((sum, a), b) in sums.iter_mut().zip(a).zip(b) {
            *sum += a * b;
        }
    }
    let rest: f64 = first_rest.iter().zip(second_rest).map(|(a, b)| a * b).sum();
    (sums[0] + sums[1]) + (sums[2] + sums[3]) + rest
}
