//! Dense elimination of the first columns of a front, lower triangle, column by column in memory.
//!
//! Four columns and four rows at a time, their sums kept in registers. What stands above the diagonal is not defined.

use super::NotPositive;

/// Columns that are updated at once, and rows.
const TILE: usize = 4;

/// A front while it is eliminated.
pub(super) struct DenseFront<'a> {
    /// The columns that are eliminated, from row 0.
    pub(super) columns: &'a mut [f64],
    /// The other columns, from row `rest_base`.
    pub(super) rest: &'a mut [f64],
    /// Rows, a multiple of four.
    pub(super) height: usize,
    /// Columns that are eliminated.
    pub(super) pivots: usize,
    /// All columns.
    pub(super) size: usize,
}

/// Some columns that follow each other, from row `base`.
struct Strip<'a> {
    values: &'a mut [f64],
    /// Index of the first column, which is the row of its diagonal.
    first: usize,
    base: usize,
    height: usize,
}

impl DenseFront<'_> {
    /// Turns the columns into those of the factor, and takes their products from the rest. `coefficients` is room.
    /// Cost: about size² · pivots multiplications, less where the rest is small.
    ///
    /// # Errors
    /// A pivot is not positive.
    pub(super) fn eliminate(&mut self, coefficients: &mut Vec<[f64; TILE]>) -> Result<(), NotPositive> {
        let (height, pivots) = (self.height, self.pivots);
        for first in (0..pivots).step_by(TILE) {
            let (done, open) = self.columns.split_at_mut(first * height);
            let width = TILE.min(pivots - first);
            let mut strip = Strip { values: &mut open[..width * height], first, base: 0, height };
            strip.subtract(done, height, coefficients);
            strip.eliminate()?;
        }
        let base = pivots - pivots % TILE;
        let rest_height = height - base;
        for first in (pivots..self.size).step_by(TILE) {
            let begin = (first - pivots) * rest_height;
            let end = self.rest.len().min(begin + TILE * rest_height);
            let values = &mut self.rest[begin..end];
            let mut strip = Strip { values, first, base, height: rest_height };
            strip.subtract(&self.columns[..pivots * height], height, coefficients);
        }
        Ok(())
    }
}

impl Strip<'_> {
    /// Takes the products of the finished columns away.
    fn subtract(&mut self, done: &[f64], height: usize, coefficients: &mut Vec<[f64; TILE]>) {
        coefficients.clear();
        coefficients.extend(done.chunks_exact(height).map(|column| {
            let mut factors = [0.0; TILE];
            let end = height.min(self.first + TILE);
            for (factor, value) in factors.iter_mut().zip(&column[self.first..end]) {
                *factor = *value;
            }
            factors
        }));
        if coefficients.is_empty() {
            return;
        }
        let begin = self.first - self.first % TILE;
        for row in (begin..height).step_by(TILE) {
            let sums = products(done, height, row, coefficients);
            for (column, sum) in self.values.chunks_exact_mut(self.height).zip(&sums) {
                let start = row - self.base;
                for (value, product) in column[start..start + TILE].iter_mut().zip(sum) {
                    *value -= product;
                }
            }
        }
    }

    /// Eliminates the columns of the strip among themselves.
    fn eliminate(&mut self) -> Result<(), NotPositive> {
        let width = self.values.len() / self.height;
        for index in 0..width {
            let diagonal = self.first + index;
            let (before, open) = self.values.split_at_mut(index * self.height);
            let column = &mut open[diagonal..self.height];
            for other in before.chunks_exact(self.height) {
                let factor = other[diagonal];
                for (value, from) in column.iter_mut().zip(&other[diagonal..]) {
                    *value -= factor * from;
                }
            }
            let pivot = column[0];
            if !(pivot > 0.0 && pivot.is_finite()) {
                return Err(NotPositive);
            }
            let scale = 1.0 / pivot.sqrt();
            for value in column {
                *value *= scale;
            }
        }
        Ok(())
    }
}

/// Four rows of the finished columns times the coefficients.
#[inline]
fn products(done: &[f64], height: usize, row: usize, coefficients: &[[f64; TILE]]) -> [[f64; TILE]; TILE] {
    let mut sums = [[0.0; TILE]; TILE];
    for (column, factors) in done.chunks_exact(height).zip(coefficients) {
        let Some(values) = column.get(row..).and_then(<[f64]>::first_chunk::<TILE>) else { continue };
        for (sum, factor) in sums.iter_mut().zip(factors) {
            for (total, value) in sum.iter_mut().zip(values) {
                *total += value * factor;
            }
        }
    }
    sums
}
