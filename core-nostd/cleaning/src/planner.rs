//! Plans and re-plans the visits: which cells of the policy in which order, with distances around obstacles.
//!
//! A cell keeps its row of distances as long as it stays in the policy, so a re-planning costs one search for the
//! robot and one for every new cell, and the tour starts from the previous one. Without a new cell nothing is solved:
//! what fell away is only taken out (book, Cleaning: Re-planning).

use heapless::Vec;

use super::tour::{Distances, TourError, TourSolver};
use floorguard_mapping::{GridCoordinates, GridGeometry};
use floorguard_navigation::{PathSearch, SEARCH_CELLS_MAX, STRAIGHT, SearchCell};
use floorguard_types::number::{exact_usize, nearest_f32, saturating_u16, truncating_u32};
use floorguard_types::random::Pcg32;

const NO_CELL: u32 = u32::MAX;
/// Stands for "cannot be reached" and for more than 226 m at 0.1 m a cell.
const FARTHEST: u16 = u16::MAX;

/// What a re-planning came to.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct PlanReport {
    /// Cells on the tour.
    pub planned: usize,
    /// Cells of the policy that were not in the previous plan.
    pub added: usize,
    /// Cells of the policy that cannot be reached: not guaranteed.
    pub unreachable: usize,
    /// Cells of the policy that did not fit into this plan; the farthest ones.
    pub postponed: usize,
    /// The order is not that of the previous plan.
    pub path_changed: bool,
}

/// What a plan must know of each cell of the raster.
#[derive(Clone, Copy, Debug)]
pub struct PlanCells<W, P> {
    /// The cell belongs to the policy: it is to be visited.
    pub wanted: W,
    /// The robot can stand there: the raster inflated by it.
    pub passable: P,
}

/// Plans tours over at most `N` − 2 cells. `S` stores the search, `D` N·N distances.
#[derive(Clone, Debug)]
pub struct Planner<S, D, const N: usize> {
    search: PathSearch<S>,
    distances: D,
    /// Cell of every node; node 0 is the robot.
    cells: [u32; N],
    /// The tour: nodes in the order of the visit, without the robot.
    order: Vec<u16, N>,
    solver: TourSolver<N>,
}

/// Distances among the nodes that take part in a tour, counted 0..n.
struct Selected<'a> {
    distances: &'a [u16],
    nodes: &'a [u16],
    side: usize,
}

impl Distances for Selected<'_> {
    #[inline]
    fn between(&self, from: u16, to: u16) -> i32 {
        let node = |i: u16| self.nodes.get(usize::from(i)).copied().map_or(0, usize::from);
        let index = node(from).wrapping_mul(self.side).wrapping_add(node(to));
        self.distances.get(index).copied().map_or(i32::from(FARTHEST), i32::from)
    }
}

impl<S, D, const N: usize> Planner<S, D, N>
where
    S: AsRef<[SearchCell]> + AsMut<[SearchCell]>,
    D: AsRef<[u16]> + AsMut<[u16]>,
{
    /// An empty plan over the raster of `search`.
    #[must_use]
    pub fn new(search: PathSearch<S>, distances: D, random: Pcg32) -> Self {
        Self { search, distances, cells: [NO_CELL; N], order: Vec::new(), solver: TourSolver::new(random) }
    }

    /// The raster.
    #[must_use]
    pub const fn geometry(&self) -> &GridGeometry {
        self.search.geometry()
    }

    /// Cells in the order of the visit.
    pub fn tour(&self) -> impl Iterator<Item = usize> + '_ {
        self.order.iter().map(|&node| self.cell_of(node))
    }

    fn cell_of(&self, node: u16) -> usize {
        self.cells.get(usize::from(node)).map_or(usize::MAX, |&cell| exact_usize(cell))
    }

    /// The first cell was visited, or is given up for now.
    pub fn drop_first(&mut self) {
        if !self.order.is_empty() {
            let node = self.order.remove(0);
            self.release(node);
        }
    }

    fn release(&mut self, node: u16) {
        if let Some(cell) = self.cells.get_mut(usize::from(node)) {
            *cell = NO_CELL;
        }
    }

    /// Plans anew from the robot's cell. Makes `experiments` attempts to shorten the tour.
    ///
    /// # Errors
    /// Only if the tour solver has less capacity than the planner, which the types rule out.
    pub fn replan(
        &mut self,
        robot_cell: usize,
        cells: &PlanCells<impl Fn(usize) -> bool, impl Fn(usize) -> bool>,
        experiments: u32,
    ) -> Result<PlanReport, TourError> {
        let PlanCells { wanted, passable } = cells;
        let mut report = PlanReport::default();
        let before: Vec<u16, N> = self.order.clone();
        let before_cells = self.cells;
        self.drop_unwanted(wanted);
        if self.has_new(wanted, &mut report) {
            self.search.run(robot_cell, passable);
            if let Some(cell) = self.cells.first_mut() {
                *cell = truncating_u32(robot_cell);
            }
            let first_new = self.order.len();
            self.add_wanted(wanted, &mut report);
            self.fill_row(0);
            for index in first_new..self.order.len() {
                let node = self.order.get(index).copied().unwrap_or(0);
                self.search.run(self.cell_of(node), passable);
                self.fill_row(node);
            }
            self.insert_cheapest(first_new);
            if report.added > 0 {
                self.solve(experiments)?;
            }
        }
        report.planned = self.order.len();
        report.path_changed = self.order.len() != before.len()
            || self.order.iter().zip(&before).any(|(&now, &then)| {
                self.cell_of(now)
                    != before_cells.get(usize::from(then)).map_or(usize::MAX, |&c| exact_usize(c))
            });
        Ok(report)
    }

    /// Some cell of the policy should join the tour. While more wait than fit, they come in batches of an eighth of the
    /// capacity, so that not every visit leads to a new tour.
    fn has_new(&self, wanted: &impl Fn(usize) -> bool, report: &mut PlanReport) -> bool {
        let cells = (0..self.search.geometry().cell_count()).take(SEARCH_CELLS_MAX);
        let all = cells.filter(|&cell| wanted(cell)).count();
        let new = all.saturating_sub(self.order.len());
        let free_slots = N.saturating_sub(2).saturating_sub(self.order.len());
        let is_batch = new <= free_slots || free_slots >= N / 8;
        report.postponed = if is_batch { 0 } else { new };
        new > 0 && is_batch
    }

    fn drop_unwanted(&mut self, wanted: &impl Fn(usize) -> bool) {
        let order = core::mem::take(&mut self.order);
        for node in order {
            if wanted(self.cell_of(node)) {
                // The list was as long before.
                let _never_full = self.order.push(node);
            } else {
                self.release(node);
            }
        }
    }

    /// Appends the cells of the policy that are not planned yet, nearest first where capacity is short; expects
    /// the search from the robot.
    fn add_wanted(&mut self, wanted: &impl Fn(usize) -> bool, report: &mut PlanReport) {
        let free_slots = N.saturating_sub(2).saturating_sub(self.order.len());
        let limit = self.distance_limit(wanted, free_slots);
        for cell in 0..self.search.geometry().cell_count().min(SEARCH_CELLS_MAX) {
            if !wanted(cell) || self.is_planned(cell) {
                continue;
            }
            let Some(distance) = self.search.distance(cell) else {
                report.unreachable = report.unreachable.saturating_add(1);
                continue;
            };
            if distance > limit || self.order.len() >= N.saturating_sub(2) || !self.take_node(cell) {
                report.postponed = report.postponed.saturating_add(1);
                continue;
            }
            report.added = report.added.saturating_add(1);
        }
    }

    fn is_planned(&self, cell: usize) -> bool {
        self.order.iter().any(|&node| self.cell_of(node) == cell)
    }

    fn take_node(&mut self, cell: usize) -> bool {
        let free = self.cells.iter().skip(1).position(|&c| c == NO_CELL);
        let Some(node) = free.and_then(|i| u16::try_from(i.saturating_add(1)).ok()) else { return false };
        if let Some(entry) = self.cells.get_mut(usize::from(node)) {
            *entry = truncating_u32(cell);
        }
        self.order.push(node).is_ok()
    }

    /// Distance from the robot within which the wanted cells fit the capacity; `u32::MAX` if all do. A histogram of 2
    /// m a bin, so the last bin may be cut off early.
    fn distance_limit(&self, wanted: &impl Fn(usize) -> bool, free_slots: usize) -> u32 {
        const BINS: usize = 256;
        let per_bin = STRAIGHT.saturating_mul(20);
        let mut bins = [0_usize; BINS];
        let mut all = 0_usize;
        for cell in 0..self.search.geometry().cell_count().min(SEARCH_CELLS_MAX) {
            if !wanted(cell) {
                continue;
            }
            let Some(distance) = self.search.distance(cell) else { continue };
            all = all.saturating_add(1);
            let bin = exact_usize(distance / per_bin);
            if let Some(count) = bins.get_mut(bin.min(BINS.saturating_sub(1))) {
                *count = count.saturating_add(1);
            }
        }
        if all <= free_slots {
            return u32::MAX;
        }
        let mut sum = 0_usize;
        for (count, bin) in bins.iter().zip(1_u32..) {
            sum = sum.saturating_add(*count);
            if sum >= free_slots {
                return per_bin.saturating_mul(bin);
            }
        }
        u32::MAX
    }

    /// Distances from a node to all others after a search from its cell. The raster overestimates skew paths by up
    /// to 8 %: the ratio of straight line to the raster's own free-space distance takes that back.
    fn fill_row(&mut self, node: u16) {
        let geometry = *self.search.geometry();
        let GridCoordinates { column, row } = geometry.coordinates(self.cell_of(node));
        for (other, &cell) in self.cells.iter().enumerate() {
            if cell == NO_CELL {
                continue;
            }
            let distance = match self.search.distance(exact_usize(cell)) {
                Some(units) => {
                    let GridCoordinates { column: x, row: y } = geometry.coordinates(exact_usize(cell));
                    saturating_u16(
                        (nearest_f32(units) * straightness(x.abs_diff(column), y.abs_diff(row)) + 0.5)
                            .min(65_534.0),
                    )
                }
                None => FARTHEST,
            };
            let (a, b) = (usize::from(node), other);
            for index in [a.wrapping_mul(N).wrapping_add(b), b.wrapping_mul(N).wrapping_add(a)] {
                if let Some(entry) = self.distances.as_mut().get_mut(index) {
                    *entry = distance;
                }
            }
        }
    }

    fn distance(&self, a: u16, b: u16) -> i32 {
        let index = usize::from(a).wrapping_mul(N).wrapping_add(usize::from(b));
        self.distances.as_ref().get(index).copied().map_or(i32::from(FARTHEST), i32::from)
    }

    /// Moves the nodes from `first_new` on, one by one, to where they lengthen the tour least.
    fn insert_cheapest(&mut self, first_new: usize) {
        for index in first_new..self.order.len() {
            let Some(&node) = self.order.get(index) else { return };
            let mut best = (i32::MAX, index);
            let mut previous = 0_u16;
            for (place, &next) in self.order.iter().take(index).enumerate() {
                let cost = self
                    .distance(previous, node)
                    .wrapping_add(self.distance(node, next))
                    .wrapping_sub(self.distance(previous, next));
                if cost < best.0 {
                    best = (cost, place);
                }
                previous = next;
            }
            if self.distance(previous, node) < best.0 {
                best.1 = index;
            }
            if let Some(part) = self.order.get_mut(best.1..=index) {
                part.rotate_right(1);
            }
        }
    }

    fn solve(&mut self, experiments: u32) -> Result<(), TourError> {
        let mut nodes: Vec<u16, N> = Vec::new();
        let mut start: Vec<u16, N> = Vec::new();
        for (&node, position) in core::iter::once(&0).chain(&self.order).zip(0_u16..) {
            // One more than the order, which is at most N − 2 long.
            let _never_full = (nodes.push(node), start.push(position));
        }
        let selected = Selected { distances: self.distances.as_ref(), nodes: &nodes, side: N };
        self.solver.start_from(&start, &selected)?;
        self.solver.improve(experiments, &selected);
        self.order.clear();
        for position in self.solver.order().skip(1) {
            let _never_full = self.order.push(nodes.get(usize::from(position)).copied().unwrap_or(0));
        }
        Ok(())
    }

    /// Length of the planned tour from the robot's cell, metres.
    #[must_use]
    pub fn length_m(&self) -> f32 {
        let mut previous = 0_u16;
        let mut sum = 0_i64;
        for &node in &self.order {
            sum = sum.saturating_add(i64::from(self.distance(previous, node)));
            previous = node;
        }
        nearest_f32(sum) / nearest_f32(STRAIGHT) * self.search.geometry().resolution_m()
    }
}

/// Straight line over octile distance, within [0.92, 1].
fn straightness(dx: u32, dy: u32) -> f32 {
    let (long, short) = (nearest_f32(dx.max(dy)), nearest_f32(dx.min(dy)));
    let octile = long + (core::f32::consts::SQRT_2 - 1.0) * short;
    if octile > 0.0 { libm::sqrtf(long * long + short * short) / octile } else { 1.0 }
}

#[cfg(test)]
mod tests {
    use super::*;
    use floorguard_types::geometry::Point2;
    use std::vec;

    type TestPlanner = Planner<vec::Vec<SearchCell>, vec::Vec<u16>, 32>;

    fn planner() -> TestPlanner {
        let geometry = GridGeometry::new(20, 20, 0.1, Point2::default()).unwrap();
        Planner::new(
            PathSearch::new(geometry, vec![SearchCell::EMPTY; 400]),
            vec![0; 32 * 32],
            Pcg32::new(1, 1),
        )
    }

    #[test]
    fn wall_detour_keeps_known_distances() {
        let mut planner = planner();
        let geometry = *planner.geometry();
        // A wall at column 10 with a gap in row 19.
        let passable = |cell| {
            let GridCoordinates { column, row } = geometry.coordinates(cell);
            column != 10 || row == 19
        };
        let at = |x, y| geometry.index(x, y).unwrap();
        let wanted = [at(5, 5), at(15, 5), at(5, 15)];
        let report =
            planner.replan(at(5, 0), &PlanCells { wanted: |c| wanted.contains(&c), passable }, 100).unwrap();
        assert_eq!((report.planned, report.added, report.unreachable), (3, 3, 0));
        let tour: vec::Vec<usize> = planner.tour().collect();
        assert_eq!(tour, [at(5, 5), at(5, 15), at(15, 5)]);
        let again =
            planner.replan(at(5, 0), &PlanCells { wanted: |c| wanted.contains(&c), passable }, 100).unwrap();
        assert!(!again.path_changed && again.added == 0);
        let fewer = planner
            .replan(at(5, 5), &PlanCells { wanted: |c| wanted[1..].contains(&c), passable }, 100)
            .unwrap();
        assert!(fewer.path_changed && fewer.planned == 2);
        // 10 up, then through the gap and down again.
        assert!(planner.length_m() > 1.0 + 1.4 && planner.length_m() < 4.0, "{}", planner.length_m());
    }

    #[test]
    fn unreachable_and_overflowing_cells_are_counted() {
        let mut planner = planner();
        let geometry = *planner.geometry();
        let passable = |cell| geometry.coordinates(cell).column != 10;
        let report = planner
            .replan(0, &PlanCells { wanted: |c| geometry.coordinates(c).row < 4, passable }, 10)
            .unwrap();
        // 10 columns can be reached in four rows: 40 cells, of which 30 fit; the wall's and those behind it cannot.
        assert_eq!((report.planned, report.postponed, report.unreachable), (30, 10, 40));
    }
}
