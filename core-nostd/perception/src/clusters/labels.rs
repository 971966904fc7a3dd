//! Provisional labels of the cells of a range image, and which of them name the same cluster.
//!
//! A cell takes the label of a neighbour that it belongs to; only where two labels meet must be remembered that they
//! are one. So the table is as large as there are labels, not cells.

use floorguard_types::number::truncating_u16;
use floorguard_types::profile::{Entry, Size, Table, TableOf};

/// A cell that belongs to nothing.
pub(crate) const NONE: u16 = u16::MAX;
/// A mark with this bit holds the index of a cluster, one without it the number of cells.
const INDEX: u16 = 0x8000;
/// Marks a set whose cluster was given up for a nearer one.
const DROPPED: u16 = NONE - 1;

/// Bound of a walk to the root. Joining always hangs the later label below the earlier root and every walk halves its
/// path, so real walks are short; one that reached the bound would stay split, never hang.
const WALK_MAX: usize = 64;

/// What a set of labels stands for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Mark {
    /// So many cells; no cluster was made of them yet.
    Cells(u16),
    /// The cluster of this index.
    Cluster(usize),
    /// Its cluster was given up.
    Dropped,
}

/// Union–find with path halving, over labels.
#[derive(Clone, Debug)]
pub(super) struct Labels<S: Size> {
    parents: TableOf<u16, S>,
    marks: TableOf<u16, S>,
    used: usize,
    /// Labels that may be used.
    capacity: usize,
}

impl<S: Size> Labels<S> {
    pub(super) const fn new() -> Self {
        Self { parents: Entry::BLANK, marks: Entry::BLANK, used: 0, capacity: S::N }
    }

    /// Clears everything, with capacity for so many labels, at most those of the profile.
    pub(super) fn clear(&mut self, labels_max: usize) {
        (self.used, self.capacity) = (0, labels_max);
    }

    /// A label that nothing has yet; `None` if there is no more.
    pub(super) fn fresh(&mut self) -> Option<u16> {
        if self.used >= self.capacity.min(S::N) {
            return None;
        }
        let (parent, mark) = (self.parents.get_mut(self.used)?, self.marks.get_mut(self.used)?);
        let label = truncating_u16(self.used);
        (*parent, *mark) = (label, 0);
        self.used += 1;
        Some(label)
    }

    /// A cell more has this label.
    pub(super) fn count(&mut self, label: u16) {
        if let Some(mark) = self.marks.get_mut(usize::from(label)) {
            // At most 29,184 cells: never reaches the index bit.
            *mark = mark.saturating_add(1);
        }
    }

    /// The set of a label.
    fn root(&mut self, label: u16) -> u16 {
        let mut current = label;
        for _ in 0..WALK_MAX {
            let Some(parent) = self.parents.get(usize::from(current)).copied() else { return NONE };
            if parent == current {
                return parent;
            }
            let grandparent = self.parents.get(usize::from(parent)).copied().unwrap_or(parent);
            if let Some(entry) = self.parents.get_mut(usize::from(current)) {
                *entry = grandparent;
            }
            current = grandparent;
        }
        current
    }

    /// Two labels name the same cluster.
    pub(super) fn join(&mut self, first: u16, second: u16) {
        if self.parents.get(usize::from(first)) == self.parents.get(usize::from(second)) {
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

    /// Lets every label point straight at its root and adds up the cells there. Parents always have smaller numbers, so
    /// one pass upwards points, and another one adds.
    pub(super) fn flatten(&mut self) {
        for label in 0..self.used.min(S::N) {
            let Some(parent) =
                self.parents.get(label).copied().filter(|parent| usize::from(*parent) != label)
            else {
                continue;
            };
            let root = self.parents.get(usize::from(parent)).copied().unwrap_or(parent);
            let cells = self.marks.get(label).copied().unwrap_or(0);
            if let (Some(entry), Some(mark)) =
                (self.parents.get_mut(label), self.marks.get_mut(usize::from(root)))
            {
                *entry = root;
                *mark = mark.saturating_add(cells);
            }
        }
    }

    /// The set that a label belongs to, after [`Self::flatten`].
    pub(super) fn root_of(&self, label: u16) -> Option<u16> {
        self.parents.get(usize::from(label)).copied()
    }

    /// What a root stands for.
    pub(super) fn mark(&self, root: u16) -> Mark {
        match self.marks.get(usize::from(root)).copied().unwrap_or(DROPPED) {
            DROPPED => Mark::Dropped,
            mark if mark & INDEX != 0 => Mark::Cluster(usize::from(mark & !INDEX)),
            cells => Mark::Cells(cells),
        }
    }

    /// A root stands for a cluster, or for one that was given up.
    pub(super) fn set_cluster(&mut self, root: u16, cluster: Option<usize>) {
        if let Some(mark) = self.marks.get_mut(usize::from(root)) {
            *mark = cluster.map_or(DROPPED, |index| INDEX | truncating_u16(index));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use floorguard_types::profile::Of;

    const LABELS: usize = 4_096;

    #[test]
    fn joins_are_transitive_and_order_free() {
        let mut labels = std::boxed::Box::new(Labels::<Of<LABELS>>::new());
        for expected in 0..10 {
            assert_eq!(labels.fresh(), Some(expected));
            labels.count(expected);
        }
        labels.join(1, 2);
        labels.join(5, 4);
        labels.join(2, 5);
        labels.flatten();
        assert_eq!([1, 2, 4, 5].map(|label| labels.root_of(label)), [Some(1); 4]);
        assert_eq!(labels.root_of(3), Some(3));
        assert_eq!((labels.mark(1), labels.mark(3)), (Mark::Cells(4), Mark::Cells(1)));
        labels.set_cluster(1, Some(7));
        labels.set_cluster(3, None);
        assert_eq!((labels.mark(1), labels.mark(3)), (Mark::Cluster(7), Mark::Dropped));
    }

    #[test]
    fn long_chain_stays_one_set_table_ends() {
        let mut labels = std::boxed::Box::new(Labels::<Of<LABELS>>::new());
        (0..LABELS).for_each(|_| assert!(labels.fresh().is_some()));
        assert_eq!(labels.fresh(), None);
        (1..LABELS).rev().for_each(|label| labels.join((label - 1) as u16, label as u16));
        labels.flatten();
        assert!((0..LABELS).all(|label| labels.root_of(label as u16) == Some(0)));
    }
}
