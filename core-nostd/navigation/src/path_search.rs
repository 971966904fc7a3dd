//! Shortest collision-free paths over the raster: Dijkstra with circular buckets.
//!
//! Steps cost 29 (straight) and 41 (diagonal), which is √2 to 0.03 %. Corners are not cut. Every cell is settled at
//! most once, so the search ends after as many steps as there are cells (book, Cleaning: Path search). A search may end
//! as soon as what it was asked for is settled, and costs nothing for the rest of the map: cells of an older search are
//! recognised by their round number.

use floorguard_mapping::{GridCoordinates, GridGeometry};
use floorguard_types::number::{exact_usize, truncating_u32};

/// Cost of a straight step; the unit of all distances on the raster is 1/29 of a cell.
pub const STRAIGHT: u32 = 29;
/// Cost of a diagonal step.
pub const DIAGONAL: u32 = 41;
/// Cells that a search may cover: a map of 4,096 × 4,096. Beyond them nothing is reached, so nothing is claimed.
pub const SEARCH_CELLS_MAX: usize = 1 << 24;
/// Circular buckets: a power of two above the largest step.
const BUCKETS: usize = 64;
/// Turns of a search: every one settles a cell or passes an empty bucket, of which at most all come in a row.
const TURNS_MAX: usize = (SEARCH_CELLS_MAX + 1) * BUCKETS;
const NO_CELL: u32 = u32::MAX;

/// Working memory of the search for one cell.
#[derive(Clone, Copy, Debug)]
pub struct SearchCell {
    distance: u32,
    next: u32,
    previous: u32,
    /// The search that reached the cell; 0 is none.
    round: u32,
}

impl SearchCell {
    /// Not reached.
    pub const EMPTY: Self = Self { distance: NO_CELL, next: NO_CELL, previous: NO_CELL, round: 0 };
}

/// A search over a raster; `S` stores one [`SearchCell`] a cell.
///
/// ```
/// use floorguard_mapping::GridGeometry;
/// use floorguard_navigation::{PathSearch, STRAIGHT, SearchCell};
/// use floorguard_types::geometry::Point2;
///
/// // A wall across a room of 5 × 3 cells, with a door in its upper row.
/// let geometry = GridGeometry::new(5, 3, 0.1, Point2::default()).unwrap();
/// let passable = |cell| cell != geometry.index(2, 0).unwrap() && cell != geometry.index(2, 1).unwrap();
/// let mut search = PathSearch::new(geometry, [SearchCell::EMPTY; 15]);
/// let (start, goal) = (geometry.index(0, 0).unwrap(), geometry.index(4, 0).unwrap());
/// search.run(start, passable);
/// // Corners are not cut: eight straight steps less one diagonal on each side of the door.
/// let distance = search.distance(goal).unwrap();
/// assert!(distance > 6 * STRAIGHT && distance < 8 * STRAIGHT);
/// assert_eq!(search.distance(geometry.index(2, 0).unwrap()), None);
/// ```
#[derive(Clone, Debug)]
pub struct PathSearch<S> {
    geometry: GridGeometry,
    cells: S,
    heads: [u32; BUCKETS],
    round: u32,
    /// Distances up to this one are final.
    horizon: u32,
}

/// Neighbours: column and row offset, cost.
const NEIGHBOURS: [(i32, i32, u32); 8] = [
    (1, 0, STRAIGHT),
    (-1, 0, STRAIGHT),
    (0, 1, STRAIGHT),
    (0, -1, STRAIGHT),
    (1, 1, DIAGONAL),
    (-1, 1, DIAGONAL),
    (1, -1, DIAGONAL),
    (-1, -1, DIAGONAL),
];

impl<S: AsRef<[SearchCell]> + AsMut<[SearchCell]>> PathSearch<S> {
    /// A search over this raster. Cells beyond the storage count as impassable.
    #[must_use]
    pub const fn new(geometry: GridGeometry, cells: S) -> Self {
        Self { geometry, cells, heads: [NO_CELL; BUCKETS], round: 0, horizon: 0 }
    }

    /// The raster.
    #[must_use]
    pub const fn geometry(&self) -> &GridGeometry {
        &self.geometry
    }

    /// Distances from `start` to all cells that can be reached over passable cells. The start itself may be
    /// impassable: a robot that stands too near a wall still gets away.
    pub fn run(&mut self, start: usize, passable: impl Fn(usize) -> bool) {
        self.run_until(start, passable, |_| false);
    }

    /// As [`Self::run`], but ends with the first cell for which `is_enough(cell)` says so. Cells are settled in the
    /// order of their distance; farther ones then count as not reached.
    pub fn run_until(
        &mut self,
        start: usize,
        passable: impl Fn(usize) -> bool,
        mut is_enough: impl FnMut(usize) -> bool,
    ) {
        self.begin();
        self.relax(start, 0);
        let count = self.geometry.cell_count();
        let mut settled = 0_usize;
        let mut empty_run = 0_usize;
        let mut bucket = 0_usize;
        for _ in 0..TURNS_MAX {
            let head = self.heads.get(bucket).copied().unwrap_or(NO_CELL);
            if head == NO_CELL {
                bucket = bucket.wrapping_add(1) % BUCKETS;
                empty_run = empty_run.saturating_add(1);
                if empty_run > BUCKETS {
                    break;
                }
                continue;
            }
            empty_run = 0;
            self.unlink(exact_usize(head));
            debug_assert!(self.raw(exact_usize(head)) >= self.horizon, "cells are settled from near to far");
            self.horizon = self.raw(exact_usize(head));
            settled = settled.saturating_add(1);
            if is_enough(exact_usize(head)) || settled >= count {
                return;
            }
            self.expand(exact_usize(head), &passable);
        }
    }

    /// Forgets the last search: a new round, and once in four thousand million rounds a sweep.
    fn begin(&mut self) {
        self.heads = [NO_CELL; BUCKETS];
        self.horizon = 0;
        self.round = self.round.wrapping_add(1);
        if self.round == 0 {
            for cell in self.cells.as_mut() {
                *cell = SearchCell::EMPTY;
            }
            self.round = 1;
        }
    }

    #[inline]
    fn expand(&mut self, cell: usize, passable: &impl Fn(usize) -> bool) {
        let GridCoordinates { column, row } = self.geometry.coordinates(cell);
        let distance = self.raw(cell);
        let mut open = [false; 8];
        for (open, (dx, dy, cost)) in open.iter_mut().zip(NEIGHBOURS).take(4) {
            let Some(other) = self.geometry.index(column.wrapping_add(dx), row.wrapping_add(dy)) else {
                continue;
            };
            if passable(other) {
                *open = true;
                self.relax(other, distance.saturating_add(cost));
            }
        }
        let [east, west, north, south, ..] = open;
        let sides = [east && north, west && north, east && south, west && south];
        for ((dx, dy, cost), clear) in NEIGHBOURS.into_iter().skip(4).zip(sides) {
            let Some(other) = self.geometry.index(column.wrapping_add(dx), row.wrapping_add(dy)) else {
                continue;
            };
            if clear && passable(other) {
                self.relax(other, distance.saturating_add(cost));
            }
        }
    }

    fn raw(&self, cell: usize) -> u32 {
        match self.cells.as_ref().get(cell) {
            Some(entry) if entry.round == self.round => entry.distance,
            _ => NO_CELL,
        }
    }

    /// Lowers the distance of a cell and moves it to the bucket where it now belongs.
    #[inline]
    fn relax(&mut self, cell: usize, distance: u32) {
        let old = self.raw(cell);
        if distance >= old {
            return;
        }
        if old != NO_CELL {
            self.unlink(cell);
        }
        let slot = exact_usize(distance) % BUCKETS;
        let head = self.heads.get(slot).copied().unwrap_or(NO_CELL);
        if let Some(entry) = self.cells.as_mut().get_mut(cell) {
            *entry = SearchCell { distance, next: head, previous: NO_CELL, round: self.round };
        }
        if let Some(entry) = self.cells.as_mut().get_mut(exact_usize(head)) {
            entry.previous = truncating_u32(cell);
        }
        if let Some(head) = self.heads.get_mut(slot) {
            *head = truncating_u32(cell);
        }
    }

    #[inline]
    fn unlink(&mut self, cell: usize) {
        let Some(&SearchCell { distance, next, previous, .. }) = self.cells.as_ref().get(cell) else {
            return;
        };
        if previous == NO_CELL {
            if let Some(head) = self.heads.get_mut(exact_usize(distance) % BUCKETS) {
                *head = next;
            }
        } else if let Some(entry) = self.cells.as_mut().get_mut(exact_usize(previous)) {
            entry.next = next;
        }
        if let Some(entry) = self.cells.as_mut().get_mut(exact_usize(next)) {
            entry.previous = previous;
        }
    }

    /// Distance of a cell from the start, in 1/29 cell; `None`: it cannot be reached.
    #[inline]
    #[must_use]
    pub fn distance(&self, cell: usize) -> Option<u32> {
        Some(self.raw(cell)).filter(|&d| d != NO_CELL && d <= self.horizon)
    }

    /// The next cell on a shortest path from `cell` to the start; `None` at the start and where there is no
    /// path.
    #[must_use]
    pub fn towards_start(&self, cell: usize) -> Option<usize> {
        let here = self.distance(cell)?;
        let GridCoordinates { column, row } = self.geometry.coordinates(cell);
        let mut best: Option<(u32, usize)> = None;
        for (dx, dy, cost) in NEIGHBOURS {
            let Some(other) = self.geometry.index(column.wrapping_add(dx), row.wrapping_add(dy)) else {
                continue;
            };
            let Some(distance) = self.distance(other) else { continue };
            let is_on_path = distance.saturating_add(cost) == here;
            // A diagonal step that fits the sum was checked for corners when it was made, or a straight one exists.
            if is_on_path
                && best.is_none_or(|(d, _)| distance < d)
                && self.has_clear_sides((column, row), (dx, dy))
            {
                best = Some((distance, other));
            }
        }
        best.map(|(_, other)| other)
    }

    fn has_clear_sides(&self, (column, row): (i32, i32), (dx, dy): (i32, i32)) -> bool {
        let reached =
            |x: i32, y: i32| self.geometry.index(x, y).is_some_and(|cell| self.raw(cell) != NO_CELL);
        dx == 0 || dy == 0 || (reached(column.wrapping_add(dx), row) && reached(column, row.wrapping_add(dy)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use floorguard_types::geometry::Point2;
    use floorguard_types::random::Pcg32;
    use std::vec;
    use std::vec::Vec;

    /// A search that ends at its goal knows the goal's distance and nothing farther.
    fn reached_early(
        search: &mut PathSearch<Vec<SearchCell>>,
        (start, goal): (usize, usize),
        free: &[bool],
        expected: u32,
    ) -> bool {
        search.run_until(start, |i| free[i], |cell| cell == goal);
        let farthest = (0..free.len()).filter_map(|i| search.distance(i)).max();
        search.distance(goal) == Some(expected) && farthest == Some(expected)
    }

    /// Against Bellman–Ford sweeps until nothing changes.
    #[test]
    fn equals_an_exhaustive_relaxation() {
        let geometry = GridGeometry::new(23, 17, 0.1, Point2::default()).unwrap();
        let count = geometry.cell_count();
        let mut random = Pcg32::new(5, 1);
        for _ in 0..20 {
            let free: Vec<bool> = (0..count).map(|_| random.bernoulli(0.7)).collect();
            let mut search = PathSearch::new(geometry, vec![SearchCell::EMPTY; count]);
            let start = random.below(count as u32) as usize;
            search.run(start, |i| free[i]);
            let mut early = PathSearch::new(geometry, vec![SearchCell::EMPTY; count]);
            let mut slow = vec![u32::MAX; count];
            slow[start] = 0;
            let is_free = |x, y| geometry.index(x, y).is_some_and(|i| free[i]);
            for _ in 0..count {
                for cell in 0..count {
                    if slow[cell] == u32::MAX {
                        continue;
                    }
                    let GridCoordinates { column: x, row: y } = geometry.coordinates(cell);
                    for (dx, dy, cost) in NEIGHBOURS {
                        let sides = dx == 0 || dy == 0 || (is_free(x + dx, y) && is_free(x, y + dy));
                        if is_free(x + dx, y + dy) && sides {
                            let other = geometry.index(x + dx, y + dy).unwrap();
                            slow[other] = slow[other].min(slow[cell] + cost);
                        }
                    }
                }
            }
            for (cell, &expected) in slow.iter().enumerate() {
                assert_eq!(search.distance(cell).unwrap_or(u32::MAX), expected);
                if expected != u32::MAX && expected > 0 {
                    assert!(reached_early(&mut early, (start, cell), &free, expected));
                    let mut here = cell;
                    for _ in 0..count {
                        let Some(next) = search.towards_start(here) else { break };
                        here = next;
                    }
                    assert_eq!(here, start, "the path leads to the start");
                }
            }
        }
    }
}
