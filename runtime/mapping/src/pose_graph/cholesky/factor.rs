//! The numbers of a factorisation: front by front up the elimination tree (Duff and Reid 1983).

use super::analysis::{Analysis, Front};
use super::front::DenseFront;
use super::{BLOCK, NotPositive};

/// A block of the matrix: row by row of the later variable, in the columns of the earlier one.
pub(in crate::pose_graph) type Block = nalgebra::Matrix3<f64>;

/// A Cholesky factor, and memory to make it.
pub(in crate::pose_graph) struct Factor {
    pub(super) analysis: Analysis,
    /// The columns of all groups.
    pub(super) values: Vec<f64>,
    /// What finished fronts pass on, the last one on top.
    waiting: Vec<f64>,
    rest: Vec<f64>,
    coefficients: Vec<[f64; 4]>,
}

impl Factor {
    /// Memory for a factor; no numbers yet.
    pub(in crate::pose_graph) fn new(analysis: Analysis) -> Self {
        let values = vec![0.0; analysis.factor_len];
        Self { analysis, values, waiting: Vec::new(), rest: Vec::new(), coefficients: Vec::new() }
    }

    /// Factors the matrix of these blocks, counted as in the analysis. Of a diagonal block the lower triangle is read.
    ///
    /// # Errors
    /// The matrix is not positive definite.
    pub(in crate::pose_graph) fn factorise(&mut self, blocks: &[Block]) -> Result<(), NotPositive> {
        self.values.fill(0.0);
        self.waiting.clear();
        // Ends of the finished fronts of which the parent is still to come.
        let mut open: Vec<usize> = Vec::new();
        for (index, front) in self.analysis.fronts.iter().enumerate() {
            let columns = &mut self.values[front.start..front.start + front.height * front.pivots];
            self.rest.clear();
            self.rest.resize(front.rest_len(), 0.0);
            assemble(front, blocks, columns);
            for _ in 0..front.children {
                let Some(child) = open.pop() else { break };
                let child = &self.analysis.fronts[child];
                let start = self.waiting.len() - child.rest_len();
                extend_add(
                    child,
                    &self.waiting[start..],
                    &mut Target { front, columns, rest: &mut self.rest },
                );
                self.waiting.truncate(start);
            }
            let (height, pivots, size) = (front.height, front.pivots, front.size);
            let mut dense = DenseFront { columns, rest: &mut self.rest, height, pivots, size };
            dense.eliminate(&mut self.coefficients)?;
            if front.parent.is_some() {
                open.push(index);
                self.waiting.extend_from_slice(&self.rest);
            }
        }
        Ok(())
    }
}

/// The matrix's own blocks.
fn assemble(front: &Front, blocks: &[Block], columns: &mut [f64]) {
    for entry in &front.entries {
        let [block, row, column] = [entry.block, entry.row, entry.column].map(|number| number as usize);
        let block = &blocks[block];
        for s in 0..BLOCK {
            let start = (BLOCK * column + s) * front.height + BLOCK * row;
            for (value, from) in columns[start..start + BLOCK].iter_mut().zip(block.column(s).iter()) {
                *value += from;
            }
        }
    }
}

struct Target<'a> {
    front: &'a Front,
    columns: &'a mut [f64],
    rest: &'a mut [f64],
}

/// Adds what a child passes on.
fn extend_add(child: &Front, passed: &[f64], target: &mut Target<'_>) {
    let front = target.front;
    // What is passed on begins below the filling of its first rows.
    let lead = child.pivots - child.rest_base();
    let columns = front.pivots / BLOCK;
    for (from, &to) in child.in_parent.iter().enumerate() {
        for s in 0..BLOCK {
            let start = (BLOCK * from + s) * child.rest_height() + lead + BLOCK * from;
            let source = &passed[start..];
            let (column, base) = if to < columns {
                let start = (BLOCK * to + s) * front.height;
                (&mut target.columns[start..start + front.height], 0)
            } else {
                let start = (BLOCK * (to - columns) + s) * front.rest_height();
                (&mut target.rest[start..start + front.rest_height()], front.rest_base())
            };
            for (block, row) in source.chunks_exact(BLOCK).zip(&child.in_parent[from..]) {
                let start = BLOCK * row - base;
                for (value, from) in column[start..start + BLOCK].iter_mut().zip(block) {
                    *value += from;
                }
            }
        }
    }
}
