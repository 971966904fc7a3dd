//! Sets of cells that belong together, in one array of indices.

use crate::capacities::{SWEEP_COLUMNS, SWEEP_RINGS};

/// Cells of a sweep.
pub(super) const CELLS: usize = SWEEP_COLUMNS * SWEEP_RINGS;
/// A cell that belongs to nothing.
pub(super) const NONE: u16 = u16::MAX;

/// Bound of a walk to the root. Linking always hangs the later cell below the earlier root and every walk halves its
/// path, so real walks are short; one that reached the bound would stay split, never hang.
const WALK_MAX: usize = 64;

/// Union–find with path halving.
#[derive(Clone, Debug)]
pub(super) struct UnionFind {
    parents: [u16; CELLS],
}

impl UnionFind {
    pub(super) const fn new() -> Self {
        Self { parents: [NONE; CELLS] }
    }

    /// Forgets everything.
    pub(super) fn clear(&mut self) {
        self.parents.fill(NONE);
    }

    /// Makes a cell a set of its own.
    pub(super) fn insert(&mut self, cell: usize) {
        if let Some(parent) = self.parents.get_mut(cell) {
            *parent = cell as u16;
        }
    }

    /// The set of a cell; [`NONE`] if it is in none.
    pub(super) fn root(&mut self, cell: usize) -> u16 {
        let mut current = cell;
        for _ in 0..WALK_MAX {
            let Some(parent) = self.parents.get(current).copied() else { return NONE };
            if parent == NONE || usize::from(parent) == current {
                return parent;
            }
            let grandparent = self.parents.get(usize::from(parent)).copied().unwrap_or(parent);
            if let Some(entry) = self.parents.get_mut(current) {
                *entry = grandparent;
            }
            current = usize::from(grandparent);
        }
        current as u16
    }

    /// Lets every cell point straight at its root. Parents always have smaller indices, so one pass upwards does it.
    pub(super) fn flatten(&mut self) {
        for cell in 0..CELLS {
            let Some(parent) = self.parents.get(cell).copied().filter(|parent| *parent != NONE) else {
                continue;
            };
            let root = self.parents.get(usize::from(parent)).copied().unwrap_or(parent);
            if let Some(entry) = self.parents.get_mut(cell) {
                *entry = root;
            }
        }
    }

    /// The parent of each cell: after [`Self::flatten`] its root, [`NONE`] if it is in no set.
    pub(super) const fn parents(&self) -> &[u16; CELLS] {
        &self.parents
    }

    /// Joins the sets of two cells that are both in one.
    pub(super) fn join(&mut self, first: usize, second: usize) {
        if self.parents.get(first) == self.parents.get(second) {
            return;
        }
        let (a, b) = (self.root(first), self.root(second));
        if a == b || a == NONE || b == NONE {
            return;
        }
        if let Some(parent) = self.parents.get_mut(usize::from(a.max(b))) {
            *parent = a.min(b);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn joins_are_transitive_and_order_free() {
        let mut sets = std::boxed::Box::new(UnionFind::new());
        (0..10).for_each(|cell| sets.insert(cell));
        sets.join(1, 2);
        sets.join(5, 4);
        sets.join(2, 5);
        assert_eq!(sets.root(4), 1);
        assert_eq!(sets.root(1), sets.root(5));
        assert_ne!(sets.root(3), sets.root(4));
        assert_eq!(sets.root(11), NONE);
    }

    #[test]
    fn a_long_chain_stays_one_set() {
        let mut sets = std::boxed::Box::new(UnionFind::new());
        (0..CELLS).for_each(|cell| sets.insert(cell));
        (1..CELLS).rev().for_each(|cell| sets.join(cell - 1, cell));
        assert!((0..CELLS).all(|cell| sets.root(cell) == 0));
        sets.flatten();
        assert!(sets.parents().iter().all(|parent| *parent == 0));
    }
}
