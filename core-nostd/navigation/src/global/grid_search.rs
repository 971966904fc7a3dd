//! Exact shortest paths on a costmap: Dijkstra and A* with circular buckets.
//!
//! A step costs what its end cell costs, diagonally 181/128 times that; corners are not cut. The outermost ring of cells is
//! impassable, as in the published planner.

use floorguard_mapping::GridCoordinates;

use super::bucket_queue::BucketQueue;
use super::grid_sweep::{BLOCKED, Place, START, Sweep, UNREACHED};
use super::step_costs::StepCosts;
use crate::costmap::{CostmapView, Costs};

/// How to search.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SearchMethod {
    /// Equally in all directions: distances to all cells that are nearer than the goal.
    Dijkstra,
    /// Towards the goal: exact at the goal, not elsewhere.
    AStar,
}

/// How a search ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SearchEnd {
    /// The goal's distance is known.
    Reached,
    /// Everything reachable was examined; the goal, if there was one, is not among it.
    Exhausted,
    /// The storage is too small for the costmap or for the entries of the search; nothing is known.
    OutOfRoom,
}

/// A search with its memory: `D` holds a word a cell, `Q` the entries that wait. For `Q` an eighth of the cells has been enough
/// for every map tried.
#[derive(Clone, Debug)]
pub struct GridSearch<D, Q> {
    distances: D,
    pool: Q,
    steps: StepCosts,
    expanded: u64,
}

impl<D: AsRef<[u32]> + AsMut<[u32]>, Q: AsRef<[u32]> + AsMut<[u32]>> GridSearch<D, Q> {
    /// A search over maps of at most as many cells as `distances` has words.
    #[must_use]
    pub const fn new(distances: D, queue: Q, steps: StepCosts) -> Self {
        Self { distances, pool: queue, steps, expanded: 0 }
    }

    /// Costs of its steps.
    #[must_use]
    pub const fn steps(&self) -> &StepCosts {
        &self.steps
    }

    /// How many cells the last search expanded.
    #[must_use]
    pub const fn expanded(&self) -> u64 {
        self.expanded
    }

    /// Distance of a cell from the start; `None`: blocked, not reached, or not of this map.
    #[inline]
    #[must_use]
    pub fn distance(&self, cell: usize) -> Option<u32> {
        let kept = self.distances.as_ref().get(cell).copied()?;
        (kept != BLOCKED && kept != UNREACHED).then(|| (kept >> 1).saturating_sub(1))
    }

    /// Searches from a cell, to a cell or over everything reachable. The start may be impassable.
    pub fn run(
        &mut self,
        costmap: CostmapView<'_>,
        start: usize,
        goal: Option<usize>,
        method: SearchMethod,
    ) -> SearchEnd {
        let geometry = costmap.geometry();
        let (costs, columns) = (costmap.costs(), geometry.columns());
        let place = |cell: usize| {
            let GridCoordinates { column, row } = geometry.coordinates(cell);
            Place { cell, column: column.unsigned_abs(), row: row.unsigned_abs() }
        };
        self.expanded = 0;
        let passes_unknown = self.steps.straight(Costs::UNKNOWN) > 0;
        let kept = self.distances.as_mut().get_mut(..costs.len());
        let Some(kept) = kept.filter(|kept| start < kept.len()) else { return SearchEnd::OutOfRoom };
        prepare(kept, (costs, columns), passes_unknown);
        if let Some(value) = kept.get_mut(start) {
            *value = START;
        }
        let mut sweep = Sweep {
            kept,
            queue: BucketQueue::new(self.pool.as_mut()),
            costs,
            columns,
            steps: &self.steps,
            goal: goal.map(place),
            expanded: 0,
        };
        let end = match method {
            SearchMethod::AStar if goal.is_some() => sweep.run::<true>(start),
            _ => sweep.run::<false>(start),
        };
        self.expanded = sweep.expanded;
        end
    }
}

/// Marks what is blocked, and the outermost ring.
fn prepare(kept: &mut [u32], (costs, columns): (&[u8], usize), passes_unknown: bool) {
    // By comparison and not by table: sixteen cells at a time.
    for (value, &cost) in kept.iter_mut().zip(costs) {
        let is_open = (cost < Costs::INSCRIBED) | (passes_unknown & (cost == Costs::UNKNOWN));
        *value = if is_open { UNREACHED } else { BLOCKED };
    }
    let columns = columns.max(1);
    for line in kept.chunks_exact_mut(columns) {
        for end in [0, columns.saturating_sub(1)] {
            if let Some(value) = line.get_mut(end) {
                *value = BLOCKED;
            }
        }
    }
    let last_row = kept.len().saturating_sub(columns);
    for begin in [0, last_row] {
        kept.get_mut(begin..begin.saturating_add(columns)).unwrap_or(&mut []).fill(BLOCKED);
    }
}
