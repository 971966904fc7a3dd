//! Equations with many pairs, solved by conjugate gradients (Hestenes and Stiefel 1952): each step is made easy by a factor of
//! what binds poses that follow each other. A full factor of the same equations costs ten times as much.

use nalgebra::{Matrix3, Vector3};

use super::block_system::{BlockSystem, PairTerms, Unsolvable};

/// How far the iteration goes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct IterativeConfig {
    /// Poses of which the numbers differ by at most so much are in the factor.
    pub band: usize,
    /// It ends once the error, weighed by the factor, is this share of the first one.
    pub share_least: f64,
    /// Steps at most.
    pub steps_max: usize,
}

impl Default for IterativeConfig {
    fn default() -> Self {
        Self { band: 12, share_least: 0.02, steps_max: 100 }
    }
}

/// The equations. Pose 0 stands still.
pub struct IterativeSystem {
    config: IterativeConfig,
    pairs: Vec<[u32; 2]>,
    near: BlockSystem,
    diagonals: Vec<Matrix3<f64>>,
    mixed: Vec<Matrix3<f64>>,
    /// Steps of the last solution.
    pub steps: usize,
}

impl IterativeSystem {
    /// Of `poses` poses with these pairs, all of them of poses that are there.
    #[must_use]
    pub fn new(poses: usize, pairs: Vec<[u32; 2]>, config: IterativeConfig) -> Self {
        Self {
            config,
            near: BlockSystem::within(poses, pairs.iter().map(wide), config.band),
            diagonals: vec![Matrix3::zeros(); poses],
            mixed: vec![Matrix3::zeros(); pairs.len()],
            pairs,
            steps: 0,
        }
    }

    /// The poses of a pair.
    #[must_use]
    pub fn pair(&self, pair: usize) -> [usize; 2] {
        wide(&self.pairs[pair])
    }

    /// Begins a new step.
    pub fn clear(&mut self) {
        self.near.clear();
        self.diagonals.fill(Matrix3::zeros());
        self.mixed.fill(Matrix3::zeros());
    }

    /// Adds the terms of a pair; `pair` counts as in `new`.
    pub fn add(&mut self, pair: usize, terms: &PairTerms) {
        let [first, second] = self.pair(pair);
        self.near.add(pair, terms);
        self.diagonals[first] += terms.first;
        self.diagonals[second] += terms.second;
        self.mixed[pair] += terms.mixed;
    }

    /// Solves for the step that the gradient asks for: three numbers for every pose but the first.
    ///
    /// # Errors
    /// The equations are not positive definite.
    pub fn solve(&mut self) -> Result<Vec<f64>, Unsolvable> {
        self.near.factorise()?;
        let mut left: Vec<f64> = self.near.gradient().iter().map(|value| -value).collect();
        let mut step = vec![0.0; left.len()];
        let mut easy = left.clone();
        self.near.solve_factored(&mut easy);
        let mut direction = easy.clone();
        let mut size = product(&left, &easy);
        let enough = size * self.config.share_least * self.config.share_least;
        self.steps = 0;
        while size > enough && self.steps < self.config.steps_max {
            self.steps += 1;
            let turned = self.times(&direction);
            let length = size / product(&direction, &turned);
            if !(length.is_finite() && length > 0.0) {
                return Err(Unsolvable);
            }
            add_scaled(&mut step, length, &direction);
            add_scaled(&mut left, -length, &turned);
            easy.copy_from_slice(&left);
            self.near.solve_factored(&mut easy);
            let before = std::mem::replace(&mut size, product(&left, &easy));
            let share = size / before;
            direction.iter_mut().zip(&easy).for_each(|(value, easy)| *value = easy + share * *value);
        }
        if step.iter().all(|value| value.is_finite()) { Ok(step) } else { Err(Unsolvable) }
    }

    /// The matrix of the equations times a vector.
    fn times(&self, vector: &[f64]) -> Vec<f64> {
        let mut all = vec![0.0; vector.len()];
        let part = |pose: usize| Some(3 * pose.checked_sub(1)?);
        for (pose, diagonal) in self.diagonals.iter().enumerate() {
            let Some(at) = part(pose) else { continue };
            add_product(&mut all[at..at + 3], diagonal, &vector[at..at + 3]);
        }
        for ([first, second], mixed) in self.pairs.iter().map(wide).zip(&self.mixed) {
            let Some((first, second)) = part(first).zip(part(second)) else { continue };
            add_product(&mut all[first..first + 3], mixed, &vector[second..second + 3]);
            add_product(&mut all[second..second + 3], &mixed.transpose(), &vector[first..first + 3]);
        }
        all
    }
}

fn wide(pair: &[u32; 2]) -> [usize; 2] {
    pair.map(|pose| pose as usize)
}

fn product(first: &[f64], second: &[f64]) -> f64 {
    first.iter().zip(second).map(|(a, b)| a * b).sum()
}

fn add_scaled(to: &mut [f64], by: f64, from: &[f64]) {
    to.iter_mut().zip(from).for_each(|(value, from)| *value += by * from);
}

fn add_product(to: &mut [f64], matrix: &Matrix3<f64>, part: &[f64]) {
    let sum = matrix * Vector3::from_column_slice(part);
    to.iter_mut().zip(sum.iter()).for_each(|(value, from)| *value += from);
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::pose_graph::{Edge, EdgeKind};
    use crate::se2::Se2;

    /// A chain that comes back to itself again and again, pulled about.
    #[test]
    fn solution_is_that_of_the_factor() {
        let poses: Vec<Se2> = (0..120_i32)
            .map(|step| Se2::new(f64::from(step % 20), f64::from(step % 7), 0.1 * f64::from(step)))
            .collect();
        let chain = (1..120).map(|step| [step - 1, step]);
        let loops = (40..120).step_by(3).map(|step| [step - 40, step]);
        let pairs: Vec<[usize; 2]> = chain.chain(loops).collect();
        let narrow = pairs.iter().map(|pair| pair.map(|pose| pose as u32)).collect();
        let mut whole = BlockSystem::new(poses.len(), &pairs);
        let config = IterativeConfig { share_least: 1.0e-9, ..IterativeConfig::default() };
        let mut iterative = IterativeSystem::new(poses.len(), narrow, config);
        for (index, &[from, to]) in pairs.iter().enumerate() {
            let pull = Se2::new(0.01 * (index % 5) as f64, 0.02, 0.01 * (index % 3) as f64);
            let measured = poses[from].between(poses[to]).compose(pull);
            let information = Matrix3::from_diagonal(&[400.0, 100.0 + index as f64, 2_500.0].into());
            let edge = Edge { from, to, measured, information, kind: EdgeKind::Sequence };
            let terms = edge.terms(poses[from], poses[to], 1.0);
            whole.add(index, &terms);
            iterative.add(index, &terms);
        }
        let (expected, found) = (whole.solve().unwrap(), iterative.solve().unwrap());
        let largest = expected.iter().fold(0.0_f64, |most, value| most.max(value.abs()));
        assert!(largest > 1.0e-3 && iterative.steps > 1, "{largest} {}", iterative.steps);
        let off = expected.iter().zip(&found).fold(0.0_f64, |most, (a, b)| most.max((a - b).abs()));
        assert!(off < 1.0e-6 * largest, "{off} of {largest}");
    }
}
