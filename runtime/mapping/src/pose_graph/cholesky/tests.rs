//! Against the equations themselves and the dense Cholesky factorisation of `nalgebra`.

use nalgebra::{Matrix3, SMatrix};

use super::factor::Block;
use super::{Analysis, Factor, NotPositive};

/// Numbers without a pattern, −1 to 1 (Knuth's generator).
struct Random(u64);

impl Random {
    fn next(&mut self) -> f64 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 11) as f64 / (1_u64 << 52) as f64 - 1.0
    }

    fn below(&mut self, count: usize) -> usize {
        ((self.next() + 1.0) * 0.5 * count as f64) as usize % count
    }

    fn block(&mut self) -> Block {
        Matrix3::from_fn(|_, _| self.next())
    }
}

/// A chain of variables with `loops` more pairs; the larger ones of each variable.
fn pattern(variables: usize, loops: usize, random: &mut Random) -> Vec<Vec<usize>> {
    let mut lower: Vec<Vec<usize>> =
        (0..variables).map(|v| if v + 1 < variables { vec![v, v + 1] } else { vec![v] }).collect();
    for _ in 0..loops {
        let (a, b) = (random.below(variables), random.below(variables));
        lower[a.min(b)].push(a.max(b));
    }
    for list in &mut lower {
        list.sort_unstable();
        list.dedup();
    }
    lower
}

/// A matrix as blocks, and each block with its row and column of variables. Its diagonal outweighs the rest by `excess`.
fn matrix(lower: &[Vec<usize>], analysis: &Analysis, excess: f64) -> (Vec<Block>, Vec<[usize; 2]>) {
    let mut random = Random(5);
    let (mut blocks, mut places) = (Vec::new(), Vec::new());
    for (variable, list) in lower.iter().enumerate() {
        for &other in list {
            let mut block = random.block();
            if other == variable {
                block = block + block.transpose() + Matrix3::identity() * excess;
            }
            // Rows of the later one in the order of elimination.
            let is_turned = analysis.position(variable) > analysis.position(other);
            blocks.push(block);
            places.push(if is_turned { [variable, other] } else { [other, variable] });
        }
    }
    (blocks, places)
}

/// What the equations say of a solution.
fn multiplied(blocks: &[Block], places: &[[usize; 2]], solution: &[f64]) -> Vec<f64> {
    let mut side = vec![0.0; solution.len()];
    for (block, &[row, column]) in blocks.iter().zip(places) {
        for i in 0..3 {
            for j in 0..3 {
                side[3 * row + i] += block[(i, j)] * solution[3 * column + j];
                if row != column {
                    side[3 * column + j] += block[(i, j)] * solution[3 * row + i];
                }
            }
        }
    }
    side
}

#[test]
fn solutions_fulfil_the_equations() {
    let mut random = Random(1);
    for (variables, loops) in [(1, 0), (2, 0), (7, 3), (40, 25), (90, 400), (700, 500)] {
        let lower = pattern(variables, loops, &mut random);
        let mut factor = Factor::new(Analysis::new(&lower));
        let (blocks, places) = matrix(&lower, &factor.analysis, 80.0);
        factor.factorise(&blocks).unwrap();
        let side: Vec<f64> = (0..3 * variables).map(|_| random.next()).collect();
        let mut solution = side.clone();
        factor.solve(&mut solution);
        let found = multiplied(&blocks, &places, &solution);
        let error = found.iter().zip(&side).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
        assert!(error < 1e-13, "{variables}: {error}");
    }
}

const DENSE: usize = 60;
type Dense = SMatrix<f64, DENSE, DENSE>;

fn dense(blocks: &[Block], places: &[[usize; 2]]) -> Dense {
    let mut dense = Dense::zeros();
    for (block, &[row, column]) in blocks.iter().zip(places) {
        dense.fixed_view_mut::<3, 3>(3 * row, 3 * column).copy_from(block);
        dense.fixed_view_mut::<3, 3>(3 * column, 3 * row).copy_from(&block.transpose());
    }
    dense
}

#[test]
fn narrow_products_are_those_of_dense_elimination() {
    let mut random = Random(9);
    let lower = pattern(DENSE / 3, 12, &mut random);
    let mut factor = Factor::new(Analysis::new(&lower));
    let (blocks, places) = matrix(&lower, &factor.analysis, 30.0);
    factor.factorise(&blocks).unwrap();
    let dense = dense(&blocks, &places).cholesky().unwrap();
    for first in 0..DENSE / 3 {
        let parts = [(first, random.block()), (random.below(DENSE / 3), random.block())];
        let mut narrow = SMatrix::<f64, DENSE, 3>::zeros();
        for (variable, part) in &parts {
            let mut rows = narrow.fixed_view_mut::<3, 3>(3 * variable, 0);
            rows += part;
        }
        let expected = narrow.transpose() * dense.solve(&narrow);
        let error = (factor.quadratic(&parts) - expected).amax();
        assert!(error < 1e-14, "{first}: {error}");
    }
}

/// The same memory serves again, after a failure too, and gives the same bits.
#[test]
fn indefinite_matrix_is_refused() {
    let lower = pattern(DENSE / 3, 15, &mut Random(3));
    let mut factor = Factor::new(Analysis::new(&lower));
    let (good, places) = matrix(&lower, &factor.analysis, 30.0);
    let (bad, _) = matrix(&lower, &factor.analysis, 1.0);
    assert!(dense(&good, &places).cholesky().is_some() && dense(&bad, &places).cholesky().is_none());
    assert_eq!(factor.factorise(&bad), Err(NotPositive));
    factor.factorise(&good).unwrap();
    let first = factor.values.clone();
    factor.factorise(&good).unwrap();
    assert_eq!(first, factor.values);
}
