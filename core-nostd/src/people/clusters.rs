//! Groups the returns that are no floor into things.
//!
//! Cells are joined with their neighbours of the range image: the same ring a few columns back, the rings below in the
//! same column. What must be close is the horizontal distance from the sensor, so the join does not depend on nested
//! rings and nothing is split at their borders (the weakness of algorithms A.1).

use heapless::Vec;

use super::union_find::{CELLS, NONE, UnionFind};
use crate::capacities::{CLUSTERS_MAX, SWEEP_COLUMNS, SWEEP_RINGS};
use crate::geometry::Point3;

/// When cells belong together.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ClusterLimits {
    /// Horizontal distances of neighbours may differ by this many metres.
    pub gap_m: f32,
    /// Things with fewer returns are dropped.
    pub points_min: u16,
    /// Returns farther than this are not grouped, metres (A.1: the outermost ring ends at 40 m).
    pub range_max_m: f32,
}

impl ClusterLimits {
    /// The values of the parameters' own documentation.
    pub const DEFAULT: Self = Self { gap_m: 0.2, points_min: 5, range_max_m: 40.0 };
}

impl Default for ClusterLimits {
    fn default() -> Self {
        Self::DEFAULT
    }
}

/// One thing.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cluster {
    /// Returns.
    pub points: u16,
    /// Smallest x, y, z in the robot's frame, metres.
    pub lower: Point3,
    /// Largest x, y, z.
    pub upper: Point3,
    /// Mean of the returns.
    pub centroid: Point3,
    /// Horizontal distance from the sensor of the nearest return, metres.
    pub nearest_m: f32,
    /// Something nearer hides its left or its right edge.
    pub occluded: bool,
    hidden_edges: u16,
    sums: [f32; 3],
    root: u16,
}

/// Columns looked back in the same ring: bridges two missing returns.
const COLUMNS_BACK: usize = 3;
/// Rings looked down in the same column: bridges one missing return.
const RINGS_DOWN: usize = 2;
/// A smooth surface may recede by this many gaps from column to column: grazing angles down to 2° at 12 m.
const SMOOTH_GAPS: i32 = 5;
/// What hides must be this much nearer, counts of 2 mm: 0.3 m.
const HIDDEN_COUNTS: u16 = 150;
/// Rings with a hidden edge that make a thing occluded; one alone is a stray return.
const HIDDEN_EDGES_MIN: u16 = 2;
/// A mark with this bit holds the index of a cluster, one without it a size.
const INDEX: u16 = 0x8000;
/// Marks a set whose cluster was given up for a nearer one.
const DROPPED: u16 = NONE - 1;

/// Working memory: 29,184 cells.
#[derive(Clone, Debug)]
pub(super) struct Clusterer {
    sets: UnionFind,
    /// Per root: first the size, then the index of its cluster.
    marks: [u16; CELLS],
    /// Horizontal distance per cell, counts of 2 mm; 0 = no obstacle.
    distances: [u16; CELLS],
    pub(super) clusters: Vec<Cluster, CLUSTERS_MAX>,
    pub(super) dropped: u32,
}

impl Clusterer {
    pub(super) const fn new() -> Self {
        Self {
            sets: UnionFind::new(),
            marks: [NONE; CELLS],
            distances: [0; CELLS],
            clusters: Vec::new(),
            dropped: 0,
        }
    }

    /// Starts a sweep.
    pub(super) fn clear(&mut self) {
        self.sets.clear();
        self.distances.fill(0);
        self.clusters.clear();
        self.dropped = 0;
    }

    /// Enters a return that is no floor and joins it with what was entered before. Columns must come in order.
    pub(super) fn enter(&mut self, column: usize, ring: usize, distance_m: f32, limits: &ClusterLimits) {
        let cell = column.saturating_mul(SWEEP_RINGS).saturating_add(ring);
        let counts = (distance_m * 500.0) as u16;
        let Some(slot) = self.distances.get_mut(cell) else { return };
        *slot = counts.max(1);
        self.sets.insert(cell);
        let gap = (limits.gap_m * 500.0) as u16;
        let backwards = (1..=COLUMNS_BACK).filter_map(|back| cell.checked_sub(back * SWEEP_RINGS));
        // The nearest neighbour that is close is enough: it is itself joined with those before it.
        let joined = { backwards }.any(|neighbour| self.join_if_close(cell, neighbour, gap));
        if !joined {
            self.join_if_smooth(cell, gap);
        }
        let _ =
            (1..=RINGS_DOWN.min(ring)).any(|down| self.join_if_close(cell, cell.saturating_sub(down), gap));
    }

    /// Joins the end of the revolution with its start.
    pub(super) fn close(&mut self, columns: usize, limits: &ClusterLimits) {
        let gap = (limits.gap_m * 500.0) as u16;
        for ring in 0..SWEEP_RINGS {
            let last = columns.saturating_sub(1).saturating_mul(SWEEP_RINGS).saturating_add(ring);
            for ahead in 0..COLUMNS_BACK {
                self.join_if_close(ahead * SWEEP_RINGS + ring, last, gap);
            }
        }
    }

    fn join_if_close(&mut self, cell: usize, neighbour: usize, gap: u16) -> bool {
        let (distance, other) = (self.counts(cell), self.counts(neighbour));
        let close = distance != 0 && other != 0 && distance.abs_diff(other) <= gap;
        if close {
            self.sets.join(cell, neighbour);
        }
        close
    }

    /// Joins a wall or a shelf that is seen at a grazing angle: its distance grows by far more than the gap from column
    /// to column, but steadily. Where a person stands before a wall the distance jumps once.
    fn join_if_smooth(&mut self, cell: usize, gap: u16) {
        let (Some(near), Some(far)) = (cell.checked_sub(SWEEP_RINGS), cell.checked_sub(2 * SWEEP_RINGS))
        else {
            return;
        };
        let distances = [self.counts(cell), self.counts(near), self.counts(far)];
        if distances.contains(&0) {
            return;
        }
        let [newest, middle, oldest] = distances.map(i32::from);
        let (step, before) = (newest.saturating_sub(middle), middle.saturating_sub(oldest));
        let gap = i32::from(gap);
        if step.abs() <= gap * SMOOTH_GAPS && step.abs_diff(before) <= gap.unsigned_abs() {
            self.sets.join(cell, near);
            self.sets.join(near, far);
        }
    }

    /// Distance in counts, 0 = no obstacle.
    fn counts(&self, cell: usize) -> u16 {
        self.distances.get(cell).copied().unwrap_or(0)
    }

    /// Counts the sets; must come after the last [`Self::enter`] and before [`Self::add`].
    pub(super) fn count(&mut self) {
        self.sets.flatten();
        self.marks.fill(0);
        for root in self.sets.parents().iter().filter(|root| **root != NONE) {
            if let Some(size) = self.marks.get_mut(usize::from(*root)) {
                // At most 29,184: never reaches the index bit.
                *size = size.saturating_add(1);
            }
        }
    }

    /// Adds the point of a cell to its cluster.
    pub(super) fn add(&mut self, column: usize, ring: usize, point: Point3, limits: &ClusterLimits) {
        let cell = column.saturating_mul(SWEEP_RINGS).saturating_add(ring);
        let Some(root) = self.sets.parents().get(cell).copied().filter(|root| *root != NONE) else { return };
        let nearest_m = f32::from(self.distances.get(cell).copied().unwrap_or(0)) * 0.002;
        let Some(index) = self.cluster_of(root, point, nearest_m, limits) else { return };
        let hidden = self.is_hidden(cell);
        if let Some(cluster) = self.clusters.get_mut(index) {
            cluster.include(point, nearest_m);
            cluster.hidden_edges = cluster.hidden_edges.saturating_add(u16::from(hidden));
        }
    }

    /// The next column of the same ring shows something nearer: it hides what may go on behind.
    fn is_hidden(&self, cell: usize) -> bool {
        let limit = self.counts(cell).saturating_sub(HIDDEN_COUNTS);
        let neighbours = [cell.saturating_sub(SWEEP_RINGS), cell.saturating_add(SWEEP_RINGS)];
        neighbours.iter().any(|neighbour| (1..limit).contains(&self.counts(*neighbour)))
    }

    /// Index of the cluster of a set; makes one at its first cell.
    fn cluster_of(
        &mut self,
        root: u16,
        point: Point3,
        nearest_m: f32,
        limits: &ClusterLimits,
    ) -> Option<usize> {
        let mark = self.marks.get(usize::from(root)).copied()?;
        if mark == DROPPED {
            return None;
        }
        if mark & INDEX != 0 {
            return Some(usize::from(mark & !INDEX));
        }
        if mark < limits.points_min {
            return None;
        }
        let index = match self.clusters.push(Cluster::start(root, point, nearest_m)) {
            Ok(()) => self.clusters.len().checked_sub(1),
            Err(fresh) => self.replace_farthest(fresh),
        };
        if let Some(mark) = self.marks.get_mut(usize::from(root)) {
            *mark = index.map_or(DROPPED, |index| INDEX | index as u16);
        }
        index
    }

    /// Out of room: the farthest thing goes first, because near ones matter (algorithms 0.3). `None` if the new one
    /// is the farthest.
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
        if let Some(mark) = self.marks.get_mut(usize::from(given_up)) {
            *mark = DROPPED;
        }
        Some(index)
    }

    /// Index of the cluster of a cell.
    pub(super) fn index_of(&self, column: usize, ring: usize) -> Option<usize> {
        let cell = column.saturating_mul(SWEEP_RINGS).saturating_add(ring);
        let root = self.sets.parents().get(cell).copied().filter(|root| *root != NONE)?;
        let mark = self.marks.get(usize::from(root)).copied()?;
        (mark != DROPPED && mark & INDEX != 0).then(|| usize::from(mark & !INDEX))
    }

    /// Horizontal distance of the obstacle in a cell, metres; `None` if there is none.
    pub(super) fn distance_m(&self, column: usize, ring: usize) -> Option<f32> {
        let counts = self.distances.get(column.saturating_mul(SWEEP_RINGS).saturating_add(ring)).copied()?;
        (counts != 0).then(|| f32::from(counts) * 0.002)
    }

    /// Finishes the means.
    pub(super) fn finish(&mut self) {
        for cluster in &mut self.clusters {
            let count = f32::from(cluster.points.max(1));
            let [x, y, z] = cluster.sums;
            cluster.occluded = cluster.hidden_edges >= HIDDEN_EDGES_MIN;
            cluster.centroid = Point3::new(x / count, y / count, z / count);
        }
    }
}

/// Columns of a sweep that a cell index can name.
const _: () =
    assert!(CELLS == SWEEP_COLUMNS * SWEEP_RINGS && CELLS < INDEX as usize && CLUSTERS_MAX < 0x7ff0);

impl Cluster {
    fn start(root: u16, point: Point3, nearest_m: f32) -> Self {
        Self {
            points: 0,
            lower: point,
            upper: point,
            centroid: point,
            nearest_m,
            occluded: false,
            hidden_edges: 0,
            sums: [0.0; 3],
            root,
        }
    }

    fn include(&mut self, point: Point3, nearest_m: f32) {
        self.points = self.points.saturating_add(1);
        let Point3 { x_m, y_m, z_m } = point;
        self.lower = Point3::new(self.lower.x_m.min(x_m), self.lower.y_m.min(y_m), self.lower.z_m.min(z_m));
        self.upper = Point3::new(self.upper.x_m.max(x_m), self.upper.y_m.max(y_m), self.upper.z_m.max(z_m));
        let [x, y, z] = self.sums;
        self.sums = [x + x_m, y + y_m, z + z_m];
        self.nearest_m = self.nearest_m.min(nearest_m);
    }

    /// Width, depth and height of the box around it, metres.
    #[must_use]
    pub fn extent_m(&self) -> [f32; 3] {
        [self.upper.x_m - self.lower.x_m, self.upper.y_m - self.lower.y_m, self.upper.z_m - self.lower.z_m]
    }
}
