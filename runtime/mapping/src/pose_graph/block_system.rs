//! Sparse normal equations of 3 × 3 blocks. The pattern is analysed once and used for every step.

use faer::dyn_stack::{MemBuffer, MemStack};
use faer::linalg::cholesky::llt::factor::LltRegularization;
use faer::sparse::linalg::SupernodalThreshold;
use faer::sparse::linalg::amd;
use faer::sparse::linalg::cholesky::{
    CholeskySymbolicParams, LltRef, SymbolicCholesky, SymmetricOrdering, factorize_symbolic_cholesky,
};
use faer::sparse::{SparseColMatRef, SymbolicSparseColMat};
use faer::{Conj, MatMut, Par, Side, Spec};
use nalgebra::{Matrix3, Vector3};

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

/// The equations cannot be solved: not positive definite, or out of memory.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error("the equations of the pose graph cannot be solved: a part of it hangs on nothing")]
pub struct Unsolvable;

/// Where the terms of a pair go. Pose 0 stands still and has no place.
#[derive(Clone, Copy, Debug)]
struct PairPlace {
    first: Option<usize>,
    second: Option<usize>,
    /// Position of the mixed block among the blocks of its column; the column is the smaller variable.
    rank: usize,
}

/// The equations.
pub struct BlockSystem {
    places: Vec<PairPlace>,
    /// First value of each scalar column.
    columns: Vec<usize>,
    symbolic: SymbolicSparseColMat<usize>,
    cholesky: SymbolicCholesky<usize>,
    values: Vec<f64>,
    gradient: Vec<f64>,
    factor: Vec<f64>,
    memory: MemBuffer,
}

impl BlockSystem {
    /// Analyses the pattern of `poses` poses with these pairs. Pose 0 is held.
    ///
    /// # Errors
    /// Out of memory.
    pub fn new(poses: usize, pairs: &[[usize; 2]]) -> Result<Self, Unsolvable> {
        let variables = poses.saturating_sub(1);
        let mut rows: Vec<Vec<usize>> = (0..variables).map(|variable| vec![variable]).collect();
        for &[a, b] in pairs {
            if a != b && a > 0 && b > 0 {
                rows[a.min(b) - 1].push(a.max(b) - 1);
            }
        }
        for list in &mut rows {
            list.sort_unstable();
            list.dedup();
        }
        let place = |&[a, b]: &[usize; 2]| {
            let (first, second) = (a.checked_sub(1), b.checked_sub(1));
            let rank = match (first, second) {
                (Some(x), Some(y)) => rows[x.min(y)].binary_search(&x.max(y)).unwrap_or(0),
                _ => 0,
            };
            PairPlace { first, second, rank }
        };
        let places = pairs.iter().map(place).collect();
        let symbolic = scalar_pattern(&rows);
        let columns = symbolic.col_ptr().to_vec();
        let cholesky = analyse(&rows, &symbolic)?;
        let par = Par::Seq;
        let scratch = cholesky
            .factorize_numeric_llt_scratch::<f64>(par, Spec::default())
            .or(cholesky.solve_in_place_scratch::<f64>(3, par));
        let memory = MemBuffer::try_new(scratch).map_err(|_| Unsolvable)?;
        let values = vec![0.0; symbolic.row_idx().len()];
        let factor = vec![0.0; cholesky.len_val()];
        Ok(Self {
            places,
            columns,
            symbolic,
            cholesky,
            values,
            gradient: vec![0.0; 3 * variables],
            factor,
            memory,
        })
    }

    /// Begins a new step.
    pub fn clear(&mut self) {
        self.values.fill(0.0);
        self.gradient.fill(0.0);
    }

    /// Adds the terms of a pair; `pair` counts as in `new`.
    pub fn add(&mut self, pair: usize, terms: &PairTerms) {
        let Some(&place) = self.places.get(pair) else { return };
        if let Some(first) = place.first {
            self.add_diagonal(first, &terms.first, &terms.first_gradient);
        }
        if let Some(second) = place.second {
            self.add_diagonal(second, &terms.second, &terms.second_gradient);
        }
        let (Some(first), Some(second)) = (place.first, place.second) else { return };
        if first == second {
            return;
        }
        // The stored block has the larger variable's rows.
        let block = if first < second { terms.mixed.transpose() } else { terms.mixed };
        let column = 3 * first.min(second);
        for s in 0..3 {
            let start = self.columns[column + s] + (3 - s) + 3 * (place.rank - 1);
            for u in 0..3 {
                self.values[start + u] += block[(u, s)];
            }
        }
    }

    fn add_diagonal(&mut self, variable: usize, block: &Matrix3<f64>, gradient: &Vector3<f64>) {
        for s in 0..3 {
            let start = self.columns[3 * variable + s];
            for u in s..3 {
                self.values[start + u - s] += block[(u, s)];
            }
            self.gradient[3 * variable + s] += gradient[s];
        }
    }

    /// Makes the diagonal larger by a share of itself (Levenberg, Marquardt).
    pub fn damp(&mut self, share: f64) {
        for &start in &self.columns[..self.gradient.len()] {
            self.values[start] += share * self.values[start].max(1.0e-9);
        }
    }

    /// Solves for the step that the gradient asks for: one for every pose but the first.
    ///
    /// # Errors
    /// The equations are not positive definite.
    pub fn solve(&mut self) -> Result<Vec<f64>, Unsolvable> {
        let matrix = SparseColMatRef::new(self.symbolic.as_ref(), &self.values);
        let stack = MemStack::new(&mut self.memory);
        let factor = self.cholesky.factorize_numeric_llt(
            &mut self.factor,
            matrix,
            Side::Lower,
            LltRegularization::default(),
            Par::Seq,
            stack,
            Spec::default(),
        );
        if factor.is_err() {
            return Err(Unsolvable);
        }
        let mut step: Vec<f64> = self.gradient.iter().map(|value| -value).collect();
        let size = step.len();
        let stack = MemStack::new(&mut self.memory);
        let factor = LltRef::new(&self.cholesky, &self.factor);
        let rhs = MatMut::from_column_major_slice_mut(&mut step, size, 1);
        factor.solve_in_place_with_conj(Conj::No, rhs, Par::Seq, stack);
        if step.iter().all(|value| value.is_finite()) { Ok(step) } else { Err(Unsolvable) }
    }

    /// Covariance of what an edge measures, by all equations as they were last solved: J H⁻¹ Jᵀ, with the derivatives of
    /// the edge by its two poses. Cost: three solutions.
    pub fn spread(&mut self, poses: [usize; 2], derivatives: &[Matrix3<f64>; 2]) -> Matrix3<f64> {
        let size = self.gradient.len();
        let mut columns = vec![0.0; 3 * size];
        let places = poses.map(|pose| pose.checked_sub(1));
        let parts = || places.iter().zip(derivatives).filter_map(|(place, part)| Some(((*place)?, part)));
        for (variable, derivative) in parts() {
            for axis in 0..3 {
                for s in 0..3 {
                    columns[axis * size + 3 * variable + s] += derivative[(axis, s)];
                }
            }
        }
        let stack = MemStack::new(&mut self.memory);
        let factor = LltRef::new(&self.cholesky, &self.factor);
        let rhs = MatMut::from_column_major_slice_mut(&mut columns, size, 3);
        factor.solve_in_place_with_conj(Conj::No, rhs, Par::Seq, stack);
        let mut spread = Matrix3::zeros();
        for (variable, derivative) in parts() {
            for axis in 0..3 {
                let start = axis * size + 3 * variable;
                let solved = Vector3::new(columns[start], columns[start + 1], columns[start + 2]);
                spread.set_column(axis, &(spread.column(axis) + derivative * solved));
            }
        }
        spread
    }

    /// The gradient, three numbers for every pose but the first.
    #[must_use]
    pub fn gradient(&self) -> &[f64] {
        &self.gradient
    }
}

/// The lower triangle, number by number.
fn scalar_pattern(rows: &[Vec<usize>]) -> SymbolicSparseColMat<usize> {
    let mut column_start = vec![0_usize];
    let mut row_index = Vec::new();
    for (variable, list) in rows.iter().enumerate() {
        for s in 0..3 {
            row_index.extend(3 * variable + s..3 * variable + 3);
            for &below in list.iter().skip(1) {
                row_index.extend(3 * below..3 * below + 3);
            }
            column_start.push(row_index.len());
        }
    }
    let size = 3 * rows.len();
    SymbolicSparseColMat::new_checked(size, size, column_start, None, row_index)
}

/// Orders the poses, not the numbers: a third of the graph.
fn analyse(
    rows: &[Vec<usize>],
    symbolic: &SymbolicSparseColMat<usize>,
) -> Result<SymbolicCholesky<usize>, Unsolvable> {
    let variables = rows.len();
    let mut starts = vec![0_usize];
    let mut lower = Vec::new();
    for list in rows {
        lower.extend_from_slice(list);
        starts.push(lower.len());
    }
    let count = lower.len();
    let blocks = SymbolicSparseColMat::new_checked(variables, variables, starts, None, lower);
    let (mut forward, mut inverse) = (vec![0_usize; variables], vec![0_usize; variables]);
    let mut memory = MemBuffer::try_new(amd::order_maybe_unsorted_scratch::<usize>(variables, count))
        .map_err(|_| Unsolvable)?;
    // The ordering reads the pattern of A + Aᵀ: the lower triangle says it all.
    amd::order_maybe_unsorted(
        &mut forward,
        &mut inverse,
        blocks.as_ref(),
        amd::Control::default(),
        MemStack::new(&mut memory),
    )
    .map_err(|_| Unsolvable)?;
    let spread = |order: &[usize]| -> Box<[usize]> {
        order.iter().flat_map(|block| [3 * block, 3 * block + 1, 3 * block + 2]).collect()
    };
    let (forward, inverse) = (spread(&forward), spread(&inverse));
    let order = faer::perm::PermRef::new_checked(&forward, &inverse, 3 * variables);
    let parameters = CholeskySymbolicParams {
        supernodal_flop_ratio_threshold: SupernodalThreshold::AUTO,
        ..Default::default()
    };
    factorize_symbolic_cholesky(symbolic.as_ref(), Side::Lower, SymmetricOrdering::Custom(order), parameters)
        .map_err(|_| Unsolvable)
}
