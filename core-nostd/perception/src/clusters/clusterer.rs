//! Groups the returns that are no floor into clusters.
//!
//! Cells are joined with their neighbours of the range image: the same ring a few columns back, the rings below in the
//! same column. What must be close is the horizontal distance from the sensor, so the join does not depend on nested
//! rings and nothing is split at their borders (the weakness of the published clusters).

use super::cluster::{Cluster, ClusterLimits, Growth};
use super::labels::{Labels, Mark, NONE};
use super::projection::{ColumnFrame, RingAngles};
use floorguard_types::capacities::{SWEEP_COLUMNS, SWEEP_RINGS};
use floorguard_types::geometry::Point3;
use floorguard_types::number::{exact_usize, saturating_u16, short_usize};
use floorguard_types::profile::{List, ListOf, Profile, Size};

/// Columns looked back in the same ring: bridges two missing returns.
const COLUMNS_BACK: usize = 3;
/// A smooth surface may recede by this many gaps from column to column: grazing angles down to 2° at 12 m.
const SMOOTH_GAPS: i32 = 5;
/// What hides must be this much nearer, counts of 2 mm: 0.3 m.
const HIDDEN_COUNTS: u16 = 150;
/// Set in the label of a cell that has something nearer beside it.
const HIDDEN: u16 = 0x8000;

/// The obstacles of a column.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Obstacles {
    /// A bit per ring that shows one.
    pub(crate) present: u16,
    /// Their horizontal distances, counts of 2 mm, at least 1; meaningless where there is none.
    pub(crate) counts: [u16; SWEEP_RINGS],
}

const _: () = assert!(SWEEP_RINGS == 16);

/// One round per ring: a slice counts cheaper than a range.
const AT_MOST: &[(); SWEEP_RINGS] = &[(); SWEEP_RINGS];

/// The rings of the bits that are set, lowest first.
pub(crate) fn rings_of(bits: u16) -> impl Iterator<Item = usize> {
    let mut left = u32::from(bits);
    AT_MOST.iter().map_while(move |()| {
        let ring = exact_usize(left.trailing_zeros()) % SWEEP_RINGS;
        let there = left != 0;
        left &= left.wrapping_sub(1);
        there.then_some(ring)
    })
}

/// A cell of a column that was entered.
#[derive(Clone, Copy, Debug)]
struct Cell {
    count: u16,
    label: u16,
}

impl Cell {
    const EMPTY: Self = Self { count: 0, label: NONE };
}

/// A column that was entered.
type Entered = [Cell; SWEEP_RINGS];
const NO_OBSTACLES: Entered = [Cell::EMPTY; SWEEP_RINGS];
/// Columns at hand while another is entered, a power of two: those looked back at, and itself.
const RECENT: usize = 4;
const _: () = assert!(COLUMNS_BACK < RECENT && RECENT.is_power_of_two());

/// Working memory: a label per cell, the labels, and what is known of each cluster.
#[derive(Clone, Debug)]
pub(crate) struct Clusterer<P: Profile> {
    labels: Labels<P::Labels>,
    cells: [[u16; SWEEP_RINGS]; SWEEP_COLUMNS],
    /// Where the cells have labels, a bit per ring.
    present: [u16; SWEEP_COLUMNS],
    /// The newest columns, column c at c modulo their number.
    recent: [Entered; RECENT],
    /// The first columns of the revolution.
    first: [Entered; COLUMNS_BACK],
    columns: usize,
    pub(crate) clusters: ListOf<Cluster, P::Clusters>,
    pub(crate) dropped: u32,
}

impl<P: Profile> Clusterer<P> {
    pub(crate) const fn new() -> Self {
        // Labels fit beside the mark, cells of a sweep beside the index of a cluster.
        const { assert!(P::Labels::N < short_usize(HIDDEN) && P::Clusters::N < 0x7ff0) };
        Self {
            labels: Labels::new(),
            cells: [[NONE; SWEEP_RINGS]; SWEEP_COLUMNS],
            present: [0; SWEEP_COLUMNS],
            recent: [NO_OBSTACLES; RECENT],
            first: [NO_OBSTACLES; COLUMNS_BACK],
            columns: 0,
            clusters: List::EMPTY,
            dropped: 0,
        }
    }

    /// Starts a sweep.
    pub(crate) fn clear(&mut self, limits: &ClusterLimits) {
        self.labels.clear(limits.labels_max);
        (self.recent, self.first) = ([NO_OBSTACLES; RECENT], [NO_OBSTACLES; COLUMNS_BACK]);
        self.columns = 0;
        self.clusters.clear();
        self.dropped = 0;
    }

    /// Enters the obstacles of the next column and joins them with those before. Columns without any are entered, too.
    pub(crate) fn enter_column(&mut self, obstacles: &Obstacles, limits: &ClusterLimits) {
        let gap = saturating_u16(limits.gap_m * 500.0);
        let column = self.columns;
        self.forget(column);
        // The two cells below, of which the second bridges one missing return.
        let (mut below, mut under, mut expected) = (Cell::EMPTY, Cell::EMPTY, 0);
        for ring in rings_of(obstacles.present) {
            // Rings that show nothing lie between.
            match ring.wrapping_sub(expected) {
                0 => {}
                1 => (below, under) = (Cell::EMPTY, below),
                _ => (below, under) = (Cell::EMPTY, Cell::EMPTY),
            }
            let count = obstacles.counts.get(ring).copied().unwrap_or(0);
            let before = self.recent(column.wrapping_sub(1), ring);
            let (beside, hidden) = if is_close(count, before.count, gap) {
                (before.label, false)
            } else {
                self.label_behind((column, ring), (count, gap))
            };
            let label = if beside != NONE && below.label == beside {
                // Beside and below mostly are the same cluster already.
                self.labels.count(beside);
                beside
            } else {
                self.label(beside, count, [below, under], gap)
            };
            let cell = Cell { count, label };
            if let Some(slot) = self.recent.get_mut(column % RECENT).and_then(|entered| entered.get_mut(ring))
            {
                *slot = cell;
            }
            if let Some(slot) = self.cells.get_mut(column).and_then(|row| row.get_mut(ring)) {
                *slot = if hidden && label != NONE { label | HIDDEN } else { label };
            }
            (below, under, expected) = (cell, below, ring.wrapping_add(1));
        }
        if let Some(present) = self.present.get_mut(column) {
            *present = obstacles.present;
        }
        if let (Some(first), Some(entered)) = (self.first.get_mut(column), self.recent.get(column % RECENT)) {
            *first = *entered;
        }
        self.columns = column.saturating_add(1);
    }

    /// A cell of one of the newest columns; empty beside the image.
    #[inline]
    fn recent(&self, column: usize, ring: usize) -> Cell {
        let entered = self.recent.get(column % RECENT);
        entered.and_then(|entered| entered.get(ring)).copied().unwrap_or(Cell::EMPTY)
    }

    fn forget(&mut self, column: usize) {
        if let Some(entered) = self.recent.get_mut(column % RECENT) {
            *entered = NO_OBSTACLES;
        }
        if let Some(row) = self.cells.get_mut(column) {
            *row = [NONE; SWEEP_RINGS];
        }
    }

    /// The label of an obstacle whose neighbour in its ring is not close: that of one farther back. Where one of the two
    /// is much nearer, it hides what may go on behind: the other one is marked. True if that is the new one.
    #[inline(never)]
    fn label_behind(&mut self, (column, ring): (usize, usize), (count, gap): (u16, u16)) -> (u16, bool) {
        let [one, two, three] = [1, 2, 3].map(|back| self.recent(column.wrapping_sub(back), ring));
        if count != 0
            && one.count.saturating_sub(count) > HIDDEN_COUNTS
            && let Some(label) = self.cells.get_mut(column.wrapping_sub(1)).and_then(|row| row.get_mut(ring))
            && *label != NONE
        {
            *label |= HIDDEN;
        }
        let hidden = one.count != 0 && count.saturating_sub(one.count) > HIDDEN_COUNTS;
        let label = if is_close(count, two.count, gap) {
            two.label
        } else if is_close(count, three.count, gap) {
            three.label
        } else if is_smooth([count, one.count, two.count], gap) {
            self.labels.join(one.label, two.label);
            one.label
        } else {
            NONE
        };
        (label, hidden)
    }

    /// Joins an obstacle with those below it, nearest first, and names it. That below is not what is beside it.
    #[inline(never)]
    fn label(&mut self, beside: u16, count: u16, [below, under]: [Cell; 2], gap: u16) -> u16 {
        let lower = if is_close(count, below.count, gap) {
            below.label
        } else if is_close(count, under.count, gap) {
            under.label
        } else {
            NONE
        };
        let mut label = beside.min(lower);
        if lower != beside && lower != NONE && beside != NONE {
            self.labels.join(lower, beside);
        } else if label == NONE {
            // Out of labels, a cell stays alone, and that is counted.
            label = self.labels.fresh().unwrap_or(NONE);
            self.dropped = self.dropped.saturating_add(u32::from(label == NONE));
        }
        self.labels.count(label);
        label
    }

    /// Joins the end of the revolution with its start. After the last [`Self::enter_column`], before
    /// [`Self::add_column`].
    pub(crate) fn close(&mut self, limits: &ClusterLimits) {
        let gap = saturating_u16(limits.gap_m * 500.0);
        let newest = self.columns.wrapping_sub(1);
        for ring in 0..SWEEP_RINGS {
            let last = self.recent(newest, ring);
            for ahead in 0..COLUMNS_BACK {
                let cell = self.first.get(ahead).and_then(|first| first.get(ring)).copied();
                let cell = cell.unwrap_or(Cell::EMPTY);
                if cell.count != 0 && is_close(cell.count, last.count, gap) {
                    self.labels.join(cell.label, last.label);
                }
            }
        }
        self.labels.flatten();
    }

    /// Adds the points of a column to their clusters.
    pub(crate) fn add_column(
        &mut self,
        index: usize,
        (frame, raw, angles): (&ColumnFrame, &[u16; SWEEP_RINGS], &RingAngles),
        limits: &ClusterLimits,
    ) {
        let Some(labels) = self.cells.get(index).copied() else { return };
        // Neighbours mostly belong to the same cluster: it is looked up once, and written back when another one
        // follows.
        let (mut known, mut growing) = (NONE, None);
        for ring in rings_of(self.present_in(index)) {
            let (Some(label), Some(raw), Some(angle)) =
                (labels.get(ring), raw.get(ring), angles.rings.get(ring))
            else {
                continue;
            };
            let Some(plain) = plain_label(*label) else { continue };
            let (point, nearest_m) = (frame.point(*raw, *angle), frame.range_m(*raw) * angle.1);
            if plain != known {
                self.put_back(growing);
                known = plain;
                let cluster = self.cluster_of(plain, (point, nearest_m), limits);
                growing = cluster.and_then(|at| Some((at, Growth::of(self.clusters.get(at)?))));
            }
            if let Some((_, growth)) = &mut growing {
                growth.include(point, nearest_m, label.wrapping_shr(15));
            }
        }
        self.put_back(growing);
    }

    fn put_back(&mut self, growing: Option<(usize, Growth)>) {
        if let Some((at, growth)) = growing
            && let Some(cluster) = self.clusters.get_mut(at)
        {
            growth.put_back(cluster);
        }
    }

    /// Index of the cluster of a label; makes one at its first cell.
    #[inline(never)]
    fn cluster_of(&mut self, label: u16, first: (Point3, f32), limits: &ClusterLimits) -> Option<usize> {
        let root = self.labels.root_of(label)?;
        match self.labels.mark(root) {
            Mark::Dropped => return None,
            Mark::Cluster(index) => return Some(index),
            Mark::Cells(cells) if cells < limits.points_min => return None,
            Mark::Cells(_) => {}
        }
        let fresh = Cluster::start(root, first);
        let index = self.clusters.len();
        let index = if index < limits.clusters_max.min(P::Clusters::N) && self.clusters.push(fresh).is_ok() {
            Some(index)
        } else {
            self.replace_farthest(fresh)
        };
        self.labels.set_cluster(root, index);
        index
    }

    /// Full: the farthest cluster is dropped first, because near ones matter (book, Conventions: Exceeded
    /// capacities). `None` if the new one is the farthest.
    fn replace_farthest(&mut self, fresh: Cluster) -> Option<usize> {
        self.dropped = self.dropped.saturating_add(1);
        let (index, farthest) = self
            .clusters
            .iter_mut()
            .enumerate()
            .max_by(|(_, a), (_, b)| a.nearest_m.total_cmp(&b.nearest_m))?;
        if farthest.nearest_m <= fresh.nearest_m {
            return None;
        }
        let given_up = core::mem::replace(farthest, fresh).root;
        self.labels.set_cluster(given_up, None);
        Some(index)
    }

    /// Where something stands in a column of the newest image, a bit per ring.
    pub(crate) fn present_in(&self, column: usize) -> u16 {
        self.present.get(column).copied().unwrap_or(0)
    }

    /// The labels of a column, for [`Self::cluster_of_label`].
    pub(crate) fn labels_of(&self, column: usize) -> Option<&[u16; SWEEP_RINGS]> {
        self.cells.get(column).filter(|_| column < self.columns)
    }

    /// Index of the cluster that a label names.
    pub(crate) fn cluster_of_label(&self, label: u16) -> Option<usize> {
        let root = self.labels.root_of(plain_label(label)?)?;
        match self.labels.mark(root) {
            Mark::Cluster(index) => Some(index),
            Mark::Cells(_) | Mark::Dropped => None,
        }
    }

    /// Index of the cluster of a cell.
    pub(crate) fn index_of(&self, column: usize, ring: usize) -> Option<usize> {
        self.labels_of(column)?.get(ring).and_then(|label| self.cluster_of_label(*label))
    }

    /// Finishes the means.
    pub(crate) fn finish(&mut self) {
        self.clusters.iter_mut().for_each(Cluster::finish);
    }
}

/// Two obstacles at about the same distance; `other` may be none.
fn is_close(count: u16, other: u16, gap: u16) -> bool {
    other != 0 && count.abs_diff(other) <= gap
}

/// A wall or a shelf that is seen at a grazing angle: its distance grows by far more than the gap from column to column,
/// but steadily. Where a person stands before a wall the distance jumps once. Newest first.
fn is_smooth(counts: Obstacles3, gap: u16) -> bool {
    if counts.contains(&0) {
        return false;
    }
    let [newest, middle, oldest] = counts.map(i32::from);
    let (step, before) = (newest.saturating_sub(middle), middle.saturating_sub(oldest));
    let gap = i32::from(gap);
    step.abs() <= gap.saturating_mul(SMOOTH_GAPS) && step.abs_diff(before) <= gap.unsigned_abs()
}

/// Distances of three cells of a ring.
type Obstacles3 = [u16; 3];

/// A label without its mark; `None` if the cell belongs to nothing.
fn plain_label(label: u16) -> Option<u16> {
    (label != NONE).then_some(label & !HIDDEN)
}

/// Cells of a sweep fit beside the index of a cluster.
const _: () = assert!(SWEEP_COLUMNS * SWEEP_RINGS < short_usize(HIDDEN));
