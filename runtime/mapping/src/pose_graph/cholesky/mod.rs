//! Sparse Cholesky of symmetric matrices of 3 × 3 blocks: the pattern is analysed once, and factored as often as its
//! numbers change.
//!
//! Sources: Amestoy et al. 1996 (the order); Liu 1990 (elimination tree); Duff and Reid 1983 (fronts of a tree, several
//! columns at once). All sums run in one fixed order on the plain instructions of the target: the same numbers give the
//! same bits on every computer of that kind.

mod analysis;
mod factor;
mod front;
mod group;
mod order;
mod solve;
mod tree;

pub(super) use analysis::Analysis;
pub(super) use factor::{Block, Factor};

/// Rows and columns of a block.
const BLOCK: usize = 3;

/// A pivot is not positive: the matrix is not positive definite.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct NotPositive;

#[cfg(test)]
mod tests;
