//! Exact shortest paths on a costmap: Dijkstra and A* with circular buckets.
//!
//! A step costs what its end cell costs, diagonally 181/128 times that; corners are not cut. Buckets are as wide as the
//! cheapest step: nothing within a bucket can shorten anything else in it, so Dijkstra settles every cell once (Denardo and
//! Fox 1979). A* may expand a cell again, and ends with the first bucket that cannot hold a shorter path. The outermost ring
//! of cells is impassable, as in the published planner.

use floorguard_mapping::GridCoordinates;
use floorguard_types::number::{exact_usize, truncating_u32};

use super::bucket_queue::{BUCKETS, BucketQueue};
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

/// Impassable.
const BLOCKED: u32 = 0;
/// Not reached.
const UNREACHED: u32 = u32::MAX;
/// Distances are kept as 2 · (distance + 1), plus 1 once expanded; larger ones than these are not reached.
const DISTANCE_MAX: u32 = (u32::MAX >> 1) - 2;
/// Width of a bucket of Dijkstra: the cheapest step.
const WIDTH_DIJKSTRA: u32 = StepCosts::NEUTRAL;
/// Of A*: 64 buckets hold the largest step and the fall of the estimate, 1,139 + 70.
const WIDTH_ASTAR: u32 = 20;

/// A search with its memory: `D` holds a word a cell, `Q` the entries that wait. For `Q` an eighth of the cells has been enough
/// for every map tried.
#[derive(Clone, Debug)]
pub struct GridSearch<D, Q> {
    distances: D,
    queue: BucketQueue<Q>,
    steps: StepCosts,
    expanded: u64,
}

/// One run: what does not change during it.
struct Run<'a> {
    costs: &'a [u8],
    columns: usize,
    /// A* towards the goal; else Dijkstra.
    is_directed: bool,
    goal: Option<Place>,
}

#[derive(Clone, Copy)]
struct Place {
    cell: usize,
    column: u32,
    row: u32,
}

impl Run<'_> {
    /// Octile distance at the cheapest costs: never more than what is left.
    #[inline]
    fn estimate(&self, cell: usize) -> u32 {
        let Some(goal) = self.goal.filter(|_| self.is_directed) else { return 0 };
        // In 32 bits, which hold every cell: the division is what an estimate costs.
        let (cell, columns) = (truncating_u32(cell), truncating_u32(self.columns).max(1));
        let (row, column) = (cell / columns, cell % columns);
        let (dx, dy) = (column.abs_diff(goal.column), row.abs_diff(goal.row));
        let (less, more) = (dx.min(dy), dx.max(dy));
        less.wrapping_mul(StepCosts::NEUTRAL_DIAGONAL)
            .wrapping_add(more.wrapping_sub(less).wrapping_mul(StepCosts::NEUTRAL))
    }

    /// Number of the bucket of a distance. Both widths are constants: no division is left.
    #[inline]
    const fn bucket(&self, distance: u32) -> u32 {
        if self.is_directed { distance / WIDTH_ASTAR } else { distance / WIDTH_DIJKSTRA }
    }
}

impl<D: AsRef<[u32]> + AsMut<[u32]>, Q: AsRef<[u32]> + AsMut<[u32]>> GridSearch<D, Q> {
    /// A search over maps of at most as many cells as `distances` has words.
    #[must_use]
    pub const fn new(distances: D, queue: Q, steps: StepCosts) -> Self {
        Self { distances, queue: BucketQueue::new(queue), steps, expanded: 0 }
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
        let run = Run {
            costs: costmap.costs(),
            columns: geometry.columns(),
            is_directed: method == SearchMethod::AStar && goal.is_some(),
            goal: goal.map(|cell| {
                let GridCoordinates { column, row } = geometry.coordinates(cell);
                Place { cell, column: column.unsigned_abs(), row: row.unsigned_abs() }
            }),
        };
        self.queue.clear();
        self.expanded = 0;
        if !self.prepare(&run, start) {
            return SearchEnd::OutOfRoom;
        }
        let bucket = run.bucket(run.estimate(start));
        if !self.queue.push(exact_usize(bucket), truncating_u32(start)) {
            return SearchEnd::OutOfRoom;
        }
        self.sweep(&run, bucket)
    }

    /// Marks what is blocked.
    fn prepare(&mut self, run: &Run<'_>, start: usize) -> bool {
        let Some(kept) = self.distances.as_mut().get_mut(..run.costs.len()) else { return false };
        // By comparison and not by table: sixteen cells at a time.
        let passes_unknown = self.steps.straight(Costs::UNKNOWN) > 0;
        for (value, &cost) in kept.iter_mut().zip(run.costs) {
            let is_open = (cost < Costs::INSCRIBED) | (passes_unknown & (cost == Costs::UNKNOWN));
            *value = if is_open { UNREACHED } else { BLOCKED };
        }
        let columns = run.columns.max(1);
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
        if let Some(value) = kept.get_mut(start) {
            *value = 2;
        }
        start < kept.len()
    }

    /// Bucket after bucket; ends with [`BUCKETS`] empty ones in a row. Every turn takes an entry or passes a bucket, and a
    /// cell is entered at most eight times at each of its distances, so the bound is never reached.
    fn sweep(&mut self, run: &Run<'_>, first: u32) -> SearchEnd {
        let turns_max = run.costs.len().saturating_mul(BUCKETS).saturating_add(BUCKETS);
        let mut bucket = first;
        let mut empty_run = 0_usize;
        for _ in 0..turns_max {
            let Some(cell) = self.queue.pop(exact_usize(bucket)) else {
                bucket = bucket.wrapping_add(1);
                empty_run = empty_run.saturating_add(1);
                if empty_run > BUCKETS {
                    break;
                }
                if self.is_final(run, bucket) {
                    return SearchEnd::Reached;
                }
                continue;
            };
            empty_run = 0;
            let kept = match self.distances.as_mut().get_mut(exact_usize(cell)) {
                Some(kept) if *kept & 1 == 0 => {
                    *kept |= 1;
                    *kept >> 1
                }
                _ => continue,
            };
            self.expanded = self.expanded.wrapping_add(1);
            if !self.expand(run, exact_usize(cell), kept) {
                return SearchEnd::OutOfRoom;
            }
        }
        match run.goal {
            Some(goal) if self.distance(goal.cell).is_some() => SearchEnd::Reached,
            _ => SearchEnd::Exhausted,
        }
    }

    /// Nothing from this bucket on can shorten the path to the goal.
    fn is_final(&self, run: &Run<'_>, bucket: u32) -> bool {
        let distance = run.goal.and_then(|goal| self.distance(goal.cell));
        distance.is_some_and(|distance| run.bucket(distance) < bucket)
    }

    /// Looks at the eight neighbours; false: full. `kept` is the cell's distance + 1.
    #[inline]
    fn expand(&mut self, run: &Run<'_>, cell: usize, kept: u32) -> bool {
        let columns = run.columns;
        let (south, north) = (cell.wrapping_sub(columns), cell.wrapping_add(columns));
        let [east_open, west_open, north_open, south_open] =
            [cell.wrapping_add(1), cell.wrapping_sub(1), north, south].map(|to| {
                let there = self.distances.as_ref().get(to).copied().unwrap_or(BLOCKED);
                (there != BLOCKED, self.try_step(run, Step { to, there, kept, diagonal: false }))
            });
        let mut has_capacity = east_open.1 && west_open.1 && north_open.1 && south_open.1;
        let corners = [
            (north.wrapping_add(1), north_open.0 && east_open.0),
            (north.wrapping_sub(1), north_open.0 && west_open.0),
            (south.wrapping_add(1), south_open.0 && east_open.0),
            (south.wrapping_sub(1), south_open.0 && west_open.0),
        ];
        for (to, is_open) in corners {
            if is_open {
                let there = self.distances.as_ref().get(to).copied().unwrap_or(BLOCKED);
                has_capacity &= self.try_step(run, Step { to, there, kept, diagonal: true });
            }
        }
        has_capacity
    }

    /// Lowers the distance of a neighbour if this step does; false: full.
    #[inline]
    fn try_step(&mut self, run: &Run<'_>, step: Step) -> bool {
        let least = if step.diagonal { StepCosts::NEUTRAL_DIAGONAL } else { StepCosts::NEUTRAL };
        // Most neighbours are nearer to the start: seen without asking for their cost.
        if (step.kept.saturating_add(least) << 1) | 1 >= step.there {
            return true;
        }
        let cost = run.costs.get(step.to).copied().unwrap_or(u8::MAX);
        let by = if step.diagonal { self.steps.diagonal(cost) } else { self.steps.straight(cost) };
        let distance = step.kept.saturating_add(by);
        let kept = distance << 1;
        if kept | 1 >= step.there || distance > DISTANCE_MAX {
            return true;
        }
        if let Some(value) = self.distances.as_mut().get_mut(step.to) {
            *value = kept;
        }
        let key = distance.wrapping_sub(1).wrapping_add(run.estimate(step.to));
        let bucket = run.bucket(key);
        if !run.is_directed && step.there != UNREACHED {
            let before = run.bucket((step.there >> 1).wrapping_sub(1));
            if before == bucket {
                return true;
            }
        }
        self.queue.push(exact_usize(bucket), truncating_u32(step.to))
    }
}

/// A step to a neighbour: its cell, what is kept there, the distance + 1 from where it starts.
#[derive(Clone, Copy)]
struct Step {
    to: usize,
    there: u32,
    kept: u32,
    diagonal: bool,
}
