//! The loop of the searches over cells: bucket after bucket, neighbour after neighbour.
//!
//! Buckets of Dijkstra are as wide as the cheapest step: nothing within a bucket can shorten anything else in it, so every cell
//! is settled once (Denardo and Fox 1979). A* may expand a cell again, and ends with the first bucket that cannot hold a
//! shorter path. Which cells are reached, and their distances, do not depend on the order within a bucket.

use floorguard_types::number::{exact_usize, truncating_u32};

use super::bucket_queue::{BUCKETS, BucketQueue};
use super::grid_search::SearchEnd;
use super::step_costs::StepCosts;

/// Impassable.
pub(super) const BLOCKED: u32 = 0;
/// Not reached.
pub(super) const UNREACHED: u32 = u32::MAX;
/// Distances are kept as 2 · (distance + 1), plus 1 once expanded; larger ones than these are not reached.
const DISTANCE_MAX: u32 = (u32::MAX >> 1) - 2;
/// Distance 0, as it is kept.
pub(super) const START: u32 = 2;
/// Width of a bucket of Dijkstra: the cheapest step.
const WIDTH_DIJKSTRA: u32 = StepCosts::NEUTRAL;
/// Of A*: 64 buckets hold the largest step and the fall of the estimate, 1,139 + 70.
const WIDTH_ASTAR: u32 = 20;

/// A cell and where it is.
#[derive(Clone, Copy)]
pub(super) struct Place {
    pub(super) cell: usize,
    pub(super) column: u32,
    pub(super) row: u32,
}

/// One search while it runs; `kept` and `costs` have one entry a cell.
pub(super) struct Sweep<'a> {
    pub(super) kept: &'a mut [u32],
    pub(super) queue: BucketQueue<'a>,
    pub(super) costs: &'a [u8],
    pub(super) columns: usize,
    pub(super) steps: &'a StepCosts,
    pub(super) goal: Option<Place>,
    /// Cells expanded so far.
    pub(super) expanded: u64,
}

/// Three cells of a row, from this one on; beyond the map they are blocked.
#[inline]
fn three(kept: &[u32], from: usize) -> [u32; 3] {
    kept.get(from..).and_then(<[u32]>::first_chunk).copied().unwrap_or([BLOCKED; 3])
}

/// Number of the bucket of a distance. Both widths are constants: no division is left.
#[inline]
const fn bucket_of<const DIRECTED: bool>(distance: u32) -> u32 {
    if DIRECTED { distance / WIDTH_ASTAR } else { distance / WIDTH_DIJKSTRA }
}

/// Octile distance at the cheapest costs: never more than what is left.
#[inline]
const fn estimate((columns, rows): (i32, i32)) -> u32 {
    let (dx, dy) = (columns.unsigned_abs(), rows.unsigned_abs());
    let (less, more) = if dx < dy { (dx, dy) } else { (dy, dx) };
    less.wrapping_mul(StepCosts::NEUTRAL_DIAGONAL)
        .wrapping_add(more.wrapping_sub(less).wrapping_mul(StepCosts::NEUTRAL))
}

impl Sweep<'_> {
    /// Searches from a cell; `DIRECTED`: towards the goal. Ends with [`BUCKETS`] empty buckets in a row. Every turn takes an
    /// entry or passes a bucket, and a cell is entered at most eight times at each of its distances, so the bound is never
    /// reached.
    pub(super) fn run<const DIRECTED: bool>(&mut self, start: usize) -> SearchEnd {
        let mut bucket = if DIRECTED { bucket_of::<DIRECTED>(estimate(self.offsets_of(start))) } else { 0 };
        if !self.queue.push(bucket, truncating_u32(start)) {
            return SearchEnd::OutOfRoom;
        }
        let turns_max = self.costs.len().saturating_mul(BUCKETS).saturating_add(BUCKETS);
        let mut empty_run = 0_usize;
        for _ in 0..turns_max {
            let Some(cell) = self.queue.pop(bucket) else {
                bucket = bucket.wrapping_add(1);
                empty_run = empty_run.saturating_add(1);
                if empty_run > BUCKETS {
                    break;
                }
                if self.is_final::<DIRECTED>(bucket) {
                    return SearchEnd::Reached;
                }
                continue;
            };
            empty_run = 0;
            let Some(kept) = self.kept.get_mut(exact_usize(cell)).filter(|kept| **kept & 1 == 0) else {
                continue;
            };
            *kept |= 1;
            let kept = *kept >> 1;
            self.expanded = self.expanded.wrapping_add(1);
            if !self.expand::<DIRECTED>(exact_usize(cell), kept) {
                return SearchEnd::OutOfRoom;
            }
        }
        let goal = self.goal.and_then(|goal| self.distance(goal.cell));
        if goal.is_some() { SearchEnd::Reached } else { SearchEnd::Exhausted }
    }

    fn distance(&self, cell: usize) -> Option<u32> {
        let kept = self.kept.get(cell).copied()?;
        (kept != BLOCKED && kept != UNREACHED).then(|| (kept >> 1).saturating_sub(1))
    }

    /// Nothing from this bucket on can shorten the path to the goal.
    fn is_final<const DIRECTED: bool>(&self, bucket: u32) -> bool {
        let distance = self.goal.and_then(|goal| self.distance(goal.cell));
        distance.is_some_and(|distance| bucket_of::<DIRECTED>(distance) < bucket)
    }

    /// Columns and rows from the goal to a cell; zero without a goal.
    #[inline]
    fn offsets_of(&self, cell: usize) -> (i32, i32) {
        let Some(goal) = self.goal else { return (0, 0) };
        // In 32 bits, which hold every cell: the division is what an estimate costs.
        let (cell, columns) = (truncating_u32(cell), truncating_u32(self.columns).max(1));
        let (row, column) = (cell / columns, cell % columns);
        (column.wrapping_sub(goal.column).cast_signed(), row.wrapping_sub(goal.row).cast_signed())
    }

    /// Looks at the eight neighbours; false: full. `kept` is the cell's distance + 1.
    #[inline]
    fn expand<const DIRECTED: bool>(&mut self, cell: usize, kept: u32) -> bool {
        let west = cell.wrapping_sub(1);
        let (south, north) = (west.wrapping_sub(self.columns), west.wrapping_add(self.columns));
        let [south_west, due_south, south_east] = three(self.kept, south);
        let [due_west, _, due_east] = three(self.kept, west);
        let [north_west, due_north, north_east] = three(self.kept, north);
        // Most neighbours are nearer to the start or blocked: seen without asking for their cost.
        let straight = (kept.wrapping_add(StepCosts::NEUTRAL) << 1) | 1;
        let diagonal = (kept.wrapping_add(StepCosts::NEUTRAL_DIAGONAL) << 1) | 1;
        let [north_open, south_open] = [due_north, due_south].map(|there| there != BLOCKED);
        let [east_open, west_open] = [due_east, due_west].map(|there| there != BLOCKED);
        let (columns, rows) = if DIRECTED { self.offsets_of(cell) } else { (0, 0) };
        let mut has_room = true;
        let mut look = |is_nearer: bool, to: usize, there: u32, (dx, dy): (i32, i32)| {
            if is_nearer {
                let from_goal = (columns.wrapping_add(dx), rows.wrapping_add(dy));
                let is_diagonal = dx != 0 && dy != 0;
                has_room &= self.lower::<DIRECTED>(Step { to, there, kept, is_diagonal, from_goal });
            }
        };
        look(due_east > straight, west.wrapping_add(2), due_east, (1, 0));
        look(due_west > straight, west, due_west, (-1, 0));
        look(due_north > straight, north.wrapping_add(1), due_north, (0, 1));
        look(due_south > straight, south.wrapping_add(1), due_south, (0, -1));
        look(north_east > diagonal && north_open && east_open, north.wrapping_add(2), north_east, (1, 1));
        look(north_west > diagonal && north_open && west_open, north, north_west, (-1, 1));
        look(south_east > diagonal && south_open && east_open, south.wrapping_add(2), south_east, (1, -1));
        look(south_west > diagonal && south_open && west_open, south, south_west, (-1, -1));
        has_room
    }

    /// Lowers the distance of a neighbour if this step does; false: full.
    #[inline]
    fn lower<const DIRECTED: bool>(&mut self, step: Step) -> bool {
        let Step { to, there, kept, is_diagonal, from_goal } = step;
        let cost = self.costs.get(to).copied().unwrap_or(u8::MAX);
        let by = if is_diagonal { self.steps.diagonal(cost) } else { self.steps.straight(cost) };
        let distance = kept.saturating_add(by);
        if distance > DISTANCE_MAX || (distance << 1) | 1 >= there {
            return true;
        }
        if let Some(value) = self.kept.get_mut(to) {
            *value = distance << 1;
        }
        let estimate = if DIRECTED { estimate(from_goal) } else { 0 };
        let key = |distance: u32| distance.wrapping_sub(1).wrapping_add(estimate);
        let bucket = bucket_of::<DIRECTED>(key(distance));
        // It waits in this bucket already.
        if there & 1 == 0 && bucket_of::<DIRECTED>(key(there >> 1)) == bucket {
            return true;
        }
        self.queue.push(bucket, truncating_u32(to))
    }
}

/// A step to a neighbour: its cell, what is kept there, the distance + 1 from where it starts, columns and rows from the goal.
#[derive(Clone, Copy)]
struct Step {
    to: usize,
    there: u32,
    kept: u32,
    is_diagonal: bool,
    from_goal: (i32, i32),
}
