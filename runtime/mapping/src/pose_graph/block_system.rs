//! Sparse normal equations of 3 × 3 blocks. The pattern is analysed once and used for every step.

use nalgebra::{Matrix3, Vector3};

use super::cholesky::{Analysis, Block, Factor};

/// What a pair of poses adds to the normal equations; `first` and `second` as in the pair.
#[derive(Clone, Copy, Debug)]
pub struct PairTerms {
    /// Jᵀ Ω J of the first pose.
    pub first: Matrix3<f64>,
    /// The same of the second.
    pub second: Matrix3<f64>,
    /// First's Jᵀ Ω second's J.
    pub mixed: Matrix3<f64>,
    /// Jᵀ Ω e of the first pose.
    pub first_gradient: Vector3<f64>,
    /// The same of the second.
    pub second_gradient: Vector3<f64>,
}

/// The equations cannot be solved: not positive definite.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error("the equations of the pose graph cannot be solved: a part of it hangs on nothing")]
pub struct Unsolvable;

/// Where the terms of a pair go. Pose 0 stands still and has no place.
#[derive(Clone, Copy, Debug)]
struct PairPlace {
    /// Variables of both poses, and index of the mixed block; [`NO_PLACE`] where there is none.
    first: u32,
    second: u32,
    mixed: u32,
    /// The mixed block has the rows of the second pose.
    is_transposed: bool,
}

/// What has no place in the equations.
const NO_PLACE: u32 = u32::MAX;

/// The equations.
pub struct BlockSystem {
    places: Vec<PairPlace>,
    /// Index of the diagonal block of each variable.
    diagonals: Vec<usize>,
    blocks: Vec<Block>,
    gradient: Vec<f64>,
    factor: Factor,
}

impl BlockSystem {
    /// Analyses the pattern of `poses` poses with these pairs. Pose 0 is held. Pairs of poses that are not there are
    /// left out.
    #[must_use]
    pub fn new(poses: usize, pairs: &[[usize; 2]]) -> Self {
        Self::within(poses, pairs.iter().copied(), usize::MAX)
    }

    /// The same without what binds poses of which the numbers differ by more than `band`: of such pairs, only what each pose
    /// has alone is added. What is left is positive definite if the whole is.
    pub(super) fn within(poses: usize, pairs: impl Iterator<Item = [usize; 2]> + Clone, band: usize) -> Self {
        let variables = poses.saturating_sub(1);
        let mut lower: Vec<Vec<usize>> = (0..variables).map(|variable| vec![variable]).collect();
        for [a, b] in pairs.clone() {
            if a != b && a.min(b) > 0 && a.max(b) <= variables && a.abs_diff(b) <= band {
                lower[a.min(b) - 1].push(a.max(b) - 1);
            }
        }
        let mut diagonals = Vec::with_capacity(variables);
        let mut blocks = 0;
        for list in &mut lower {
            list.sort_unstable();
            list.dedup();
            // The variable itself is the smallest of its list.
            diagonals.push(blocks);
            blocks += list.len();
        }
        let analysis = Analysis::new(&lower);
        let place = |[a, b]: [usize; 2]| {
            let variable = |pose: usize| pose.checked_sub(1).filter(|variable| *variable < variables);
            let (first, second) = (variable(a), variable(b));
            let both = first.zip(second).filter(|(first, second)| first != second);
            let mixed = both.and_then(|(x, y)| {
                let rank = lower[x.min(y)].binary_search(&x.max(y)).ok()?;
                Some(diagonals[x.min(y)] + rank)
            });
            let is_transposed = both.is_some_and(|(x, y)| analysis.position(y) > analysis.position(x));
            let short = |place: Option<usize>| place.map_or(NO_PLACE, |place| place as u32);
            PairPlace { first: short(first), second: short(second), mixed: short(mixed), is_transposed }
        };
        Self {
            places: pairs.map(place).collect(),
            diagonals,
            blocks: vec![Block::zeros(); blocks],
            gradient: vec![0.0; 3 * variables],
            factor: Factor::new(analysis),
        }
    }

    /// Begins a new step.
    pub fn clear(&mut self) {
        self.blocks.fill(Block::zeros());
        self.gradient.fill(0.0);
    }

    /// Adds the terms of a pair; `pair` counts as in `new`.
    pub fn add(&mut self, pair: usize, terms: &PairTerms) {
        let Some(&place) = self.places.get(pair) else { return };
        let index = |place: u32| (place != NO_PLACE).then_some(place as usize);
        if let Some(first) = index(place.first) {
            self.add_diagonal(first, &terms.first, &terms.first_gradient);
        }
        if let Some(second) = index(place.second) {
            self.add_diagonal(second, &terms.second, &terms.second_gradient);
        }
        if let Some(mixed) = index(place.mixed) {
            self.blocks[mixed] += if place.is_transposed { terms.mixed.transpose() } else { terms.mixed };
        }
    }

    fn add_diagonal(&mut self, variable: usize, block: &Matrix3<f64>, gradient: &Vector3<f64>) {
        self.blocks[self.diagonals[variable]] += block;
        for (value, part) in self.gradient[3 * variable..].iter_mut().zip(gradient.iter()) {
            *value += part;
        }
    }

    /// Makes the diagonal larger by a share of itself (Levenberg, Marquardt).
    pub fn damp(&mut self, share: f64) {
        for &diagonal in &self.diagonals {
            for axis in 0..3 {
                let value = &mut self.blocks[diagonal][(axis, axis)];
                *value += share * value.max(1.0e-9);
            }
        }
    }

    /// Solves for the step that the gradient asks for: one for every pose but the first.
    ///
    /// # Errors
    /// The equations are not positive definite.
    pub fn solve(&mut self) -> Result<Vec<f64>, Unsolvable> {
        self.factorise()?;
        let mut step: Vec<f64> = self.gradient.iter().map(|value| -value).collect();
        self.solve_factored(&mut step);
        if step.iter().all(|value| value.is_finite()) { Ok(step) } else { Err(Unsolvable) }
    }

    /// Factors the equations as they are.
    pub(super) fn factorise(&mut self) -> Result<(), Unsolvable> {
        self.factor.factorise(&self.blocks).map_err(|_| Unsolvable)
    }

    /// Solves for another right side, in its place, with the last factor.
    pub(super) fn solve_factored(&self, side: &mut [f64]) {
        self.factor.solve(side);
    }

    /// Covariance of what an edge measures, by all equations as they were last solved: J H⁻¹ Jᵀ, with the derivatives of
    /// the edge by its two poses. Cost: the part of the factor that depends on the two poses, three times.
    #[must_use]
    pub fn spread(&self, poses: [usize; 2], derivatives: &[Matrix3<f64>; 2]) -> Matrix3<f64> {
        let places = poses.map(|pose| pose.checked_sub(1).filter(|place| *place < self.diagonals.len()));
        let parts: Vec<_> = places
            .iter()
            .zip(derivatives)
            .filter_map(|(place, part)| Some(((*place)?, part.transpose())))
            .collect();
        self.factor.quadratic(&parts)
    }

    /// The gradient, three numbers for every pose but the first.
    #[must_use]
    pub fn gradient(&self) -> &[f64] {
        &self.gradient
    }
}
