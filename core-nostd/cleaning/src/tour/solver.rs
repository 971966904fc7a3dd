//! Solves the order of visits: a first tour, local search, then small experiments that are kept if they help.
//!
//! An experiment lets two short adjacent stretches change places (a local double bridge), searches around the eight
//! loose ends, and is taken back exactly if the tour did not get shorter. The caller gives a number of experiments,
//! watches its own clock between calls, and may go on at any later tick.

use super::distances::{Distances, OpenPath};
use super::local_search::{LocalSearch, Stretch};
use floorguard_types::number::{exact_usize, truncating_u16, truncating_u32};
use floorguard_types::random::Pcg32;

/// Evaluations, for every node, that the first local search may take.
const EVALUATIONS_PER_NODE: u32 = 50;
/// Rounds of the first local search, whatever the number of nodes.
const ROUNDS_MAX: u32 = 65_536;
/// Experiments that one call may make; a caller with more time calls again.
const EXPERIMENTS_MAX: u32 = 1_000_000;
/// Evaluations of one experiment.
const EVALUATIONS_PER_EXPERIMENT: u32 = 400;
/// Longest stretch that an experiment moves.
const STRETCH_MAX: u32 = 30;
/// Fewer nodes than this leave nothing to exchange.
const NODES_MIN: usize = 8;

/// Why there is no tour.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum TourError {
    /// More nodes than capacity: visit the nearest ones first and plan again.
    TooMany {
        /// Nodes asked for, the start included.
        nodes: usize,
        /// Nodes that fit.
        capacity: usize,
    },
    /// The warm start names a node twice, or none that exists.
    NotAnOrder,
}

impl core::fmt::Display for TourError {
    fn fmt(&self, formatter: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        match self {
            Self::TooMany { nodes, capacity } => {
                write!(formatter, "a tour of {nodes} places does not fit the {capacity} that fit")
            }
            Self::NotAnOrder => {
                write!(formatter, "the order to start from is not a permutation of the places")
            }
        }
    }
}

impl core::error::Error for TourError {}

/// A tour over at most `N` − 1 nodes; node 0 is the start.
///
/// ```
/// use floorguard_cleaning::{EuclideanCells, TourSolver};
/// use floorguard_types::random::Pcg32;
///
/// let points = [(0.0, 0.0), (2.0, 1.0), (0.5, 2.0), (3.0, 3.0), (1.0, 3.5), (2.5, 0.2)];
/// let distances = EuclideanCells { points: &points, scale: 1.0e6 };
/// let mut solver = TourSolver::<16>::new(Pcg32::new(1, 1));
/// solver.start(6, &distances).unwrap();
/// assert!(solver.order().eq([0, 2, 4, 3, 1, 5]));
/// assert_eq!(solver.length(&distances) / 1_000_000, 8);
/// ```
#[derive(Clone, Debug)]
pub struct TourSolver<const N: usize> {
    search: LocalSearch<N>,
    random: Pcg32,
    nodes: usize,
    closed: bool,
}

impl<const N: usize> TourSolver<N> {
    /// No tour yet. About 32 bytes a node and 4 kB: place it once.
    #[must_use]
    pub const fn new(random: Pcg32) -> Self {
        Self { search: LocalSearch::new(), random, nodes: 0, closed: false }
    }

    /// Starts an open path over the nodes 0..`nodes` from the nearest-neighbour order, and searches locally.
    ///
    /// # Errors
    /// More nodes than fit.
    pub fn start(&mut self, nodes: usize, distances: &impl Distances) -> Result<(), TourError> {
        self.prepare(nodes, false, distances)?;
        self.nearest_neighbour_order(distances);
        self.search_everywhere(distances);
        Ok(())
    }

    /// As [`Self::start`], for a tour that returns to its start.
    ///
    /// # Errors
    /// More nodes than fit.
    pub fn start_closed(&mut self, nodes: usize, distances: &impl Distances) -> Result<(), TourError> {
        self.prepare(nodes, true, distances)?;
        self.nearest_neighbour_order(distances);
        self.search_everywhere(distances);
        Ok(())
    }

    /// Starts an open path from a known order, which begins with node 0: the previous tour without the places that
    /// fell away and with new ones inserted anywhere.
    ///
    /// # Errors
    /// More nodes than fit, or `order` is not a permutation of 0..its length that begins with 0.
    pub fn start_from(&mut self, order: &[u16], distances: &impl Distances) -> Result<(), TourError> {
        self.prepare(order.len(), false, distances)?;
        let mut seen = [false; N];
        for &node in order {
            match seen.get_mut(usize::from(node)) {
                Some(seen) if !*seen && usize::from(node) < order.len() => *seen = true,
                _ => return Err(TourError::NotAnOrder),
            }
        }
        if order.first() != Some(&0) {
            return Err(TourError::NotAnOrder);
        }
        self.search.cycle.set(order.iter().copied().chain(core::iter::once(self.end())));
        self.search_everywhere(distances);
        Ok(())
    }

    fn prepare(&mut self, nodes: usize, closed: bool, distances: &impl Distances) -> Result<(), TourError> {
        let capacity = N.min(usize::from(u16::MAX)).saturating_sub(1);
        if nodes > capacity {
            return Err(TourError::TooMany { nodes, capacity });
        }
        self.nodes = nodes;
        self.closed = closed;
        self.search.forget();
        self.search.neighbours.fill(nodes, distances);
        Ok(())
    }

    /// The node that closes an open path.
    fn end(&self) -> u16 {
        truncating_u16(self.nodes)
    }

    /// Always on to the nearest place that was not visited: nodes² distances.
    fn nearest_neighbour_order(&mut self, distances: &impl Distances) {
        let mut order = [0_u16; N];
        for (place, node) in order.iter_mut().zip(0_u16..) {
            *place = node;
        }
        for done in 1..self.nodes.min(N) {
            let here = order.get(done.wrapping_sub(1)).copied().unwrap_or(0);
            let mut best = (i32::MAX, done);
            for (offset, &node) in order.iter().take(self.nodes).skip(done).enumerate() {
                let distance = distances.between(here, node);
                if distance < best.0 {
                    best = (distance, done.wrapping_add(offset));
                }
            }
            order.swap(done, best.1);
        }
        let count = if self.closed { self.nodes } else { self.nodes.saturating_add(1) };
        self.search.cycle.set(order.iter().copied().take(count));
    }

    fn search_everywhere(&mut self, distances: &impl Distances) {
        if self.nodes < 3 {
            return;
        }
        for node in (0..self.end()).take(N) {
            self.search.wake(node);
        }
        let evaluations = truncating_u32(self.nodes).saturating_mul(EVALUATIONS_PER_NODE);
        // The first search has nothing to take back; beginning anew whenever the log is full keeps it going.
        for _ in 0..(evaluations / 64).saturating_add(1).min(ROUNDS_MAX) {
            self.search.cycle.begin();
            let gained =
                if self.closed { self.search.run(distances, 64) } else { self.run_open(distances, 64) };
            if gained == 0 && !self.search.is_waiting() {
                break;
            }
        }
        self.search.forget();
    }

    fn run_open(&mut self, distances: &impl Distances, evaluations: u32) -> i32 {
        let path = OpenPath { distances, end: self.end() };
        self.search.run(&path, evaluations)
    }

    /// Makes `experiments` experiments. Returns by how much the tour became shorter.
    pub fn improve(&mut self, experiments: u32, distances: &impl Distances) -> i32 {
        if self.nodes < NODES_MIN {
            return 0;
        }
        let mut gained = 0_i32;
        for _ in 0..experiments.min(EXPERIMENTS_MAX) {
            self.search.cycle.begin();
            let gain = if self.closed {
                self.experiment(distances)
            } else {
                self.experiment(&OpenPath { distances, end: self.end() })
            };
            if gain < 0 || self.search.cycle.is_log_full() {
                self.search.cycle.undo();
                self.search.forget();
            } else {
                gained = gained.saturating_add(gain);
            }
        }
        gained
    }

    /// A local double bridge and the search that follows; the gain may be negative.
    fn experiment(&mut self, distances: &impl Distances) -> i32 {
        let count = truncating_u32(self.search.cycle.order().len());
        let longest = STRETCH_MAX.min((count.saturating_sub(3)) / 2).max(1);
        let position = exact_usize(self.random.below(count));
        let first_length = exact_usize(self.random.below(longest).saturating_add(1));
        let second_length = exact_usize(self.random.below(longest).saturating_add(1));
        // All sums stay below two rounds; `at` takes positions of up to two rounds.
        let node =
            |offset: usize| self.search.cycle.at(position.wrapping_add(offset) % exact_usize(count).max(1));
        let outer = node(0);
        let first = Stretch { from: node(1), to: node(first_length) };
        let both = first_length.wrapping_add(second_length);
        let second = Stretch { from: node(first_length.wrapping_add(1)), to: node(both) };
        let after = node(both.wrapping_add(1));
        let between = |a, b| distances.between(a, b);
        // Kept apart from the closing bonus: an experiment that breaks the closing edge would never be kept.
        let removed = [(outer, first.from), (first.to, second.from), (second.to, after)];
        if !self.closed && removed.iter().any(|&(a, b)| self.is_closing(a, b)) {
            return 0;
        }
        let added = [(outer, second.from), (second.to, first.from), (first.to, after)];
        let sum =
            |edges: [(u16, u16); 3]| edges.iter().fold(0_i32, |s, &(a, b)| s.wrapping_add(between(a, b)));
        let loss = sum(added).wrapping_sub(sum(removed));
        self.search.exchange(outer, first, second);
        for node in [outer, first.from, first.to, second.from, second.to, after] {
            if node != self.end() {
                self.search.wake(node);
            }
        }
        self.search.run(distances, EVALUATIONS_PER_EXPERIMENT).wrapping_sub(loss)
    }

    fn is_closing(&self, a: u16, b: u16) -> bool {
        (a == self.end() && b == 0) || (b == self.end() && a == 0)
    }

    /// The nodes in the order of the visit, node 0 first.
    pub fn order(&self) -> impl Iterator<Item = u16> + '_ {
        let count = self.search.cycle.order().len();
        let start = self.search.cycle.position(0);
        // The end of an open path is beside node 0; it says which way round the path runs.
        let backwards =
            !self.closed && self.nodes > 0 && self.search.cycle.next(0) == self.end() && count > 2;
        (0..self.nodes.min(N)).map(move |step| {
            let offset = if backwards { count.wrapping_sub(step) } else { step };
            self.search.cycle.at(start.wrapping_add(offset) % count.max(1))
        })
    }

    /// Length of the tour, in the unit of the distances.
    #[must_use]
    pub fn length(&self, distances: &impl Distances) -> i64 {
        let mut previous = None;
        let mut sum = 0_i64;
        for node in self.order() {
            if let Some(previous) = previous {
                sum = sum.saturating_add(i64::from(distances.between(previous, node)));
            }
            previous = Some(node);
        }
        match previous {
            Some(last) if self.closed => sum.saturating_add(i64::from(distances.between(last, 0))),
            _ => sum,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::distances::EuclideanCells;
    use super::*;
    use std::vec::Vec;

    /// The test values of the book, Cleaning: Tour.
    #[test]
    fn golden_vector() {
        let points = [(0.0, 0.0), (2.0, 1.0), (0.5, 2.0), (3.0, 3.0), (1.0, 3.5), (2.5, 0.2)];
        let distances = EuclideanCells { points: &points, scale: 1e6 };
        let mut solver = TourSolver::<16>::new(Pcg32::new(1, 1));
        solver.start(6, &distances).unwrap();
        let order: Vec<u16> = solver.order().collect();
        assert_eq!(order, [0, 2, 4, 3, 1, 5]);
        assert!((solver.length(&distances) as f64 / 1e6 - 8.883_711).abs() < 1e-5);
    }

    /// Held–Karp: the exact optimum of an open path from node 0.
    fn optimum(count: usize, distances: &impl Distances) -> i64 {
        let full = 1_usize << (count - 1);
        let mut best = std::vec![i64::MAX / 2; full * count];
        for node in 1..count {
            best[(1 << (node - 1)) * count + node] = i64::from(distances.between(0, node as u16));
        }
        for set in 1..full {
            for last in (1..count).filter(|l| set & (1 << (l - 1)) != 0) {
                let here = best[set * count + last];
                for next in (1..count).filter(|n| set & (1 << (n - 1)) == 0) {
                    let entry = &mut best[(set | (1 << (next - 1))) * count + next];
                    *entry = (*entry).min(here + i64::from(distances.between(last as u16, next as u16)));
                }
            }
        }
        (1..count).map(|last| best[(full - 1) * count + last]).min().unwrap_or(0)
    }

    #[test]
    fn reaches_the_exact_optimum_of_small_tours() {
        let mut random = Pcg32::new(3, 3);
        for count in [1_usize, 2, 3, 5, 9, 12] {
            for _ in 0..10 {
                let points: Vec<(f32, f32)> =
                    (0..count).map(|_| (random.uniform(), random.uniform())).collect();
                let distances = EuclideanCells { points: &points, scale: 10_000.0 };
                let mut solver = TourSolver::<16>::new(Pcg32::new(1, 1));
                solver.start(count, &distances).unwrap();
                let before = solver.length(&distances);
                let gained = solver.improve(3_000, &distances);
                assert_eq!(
                    before - solver.length(&distances),
                    i64::from(gained),
                    "the gain is what was gained"
                );
                let mut order: Vec<u16> = solver.order().collect();
                assert_eq!(order[0], 0);
                order.sort_unstable();
                assert!(order.into_iter().eq(0..count as u16));
                if count > 1 && count != 9 && count != 12 {
                    continue;
                }
                let best = if count > 1 { optimum(count, &distances) } else { 0 };
                assert_eq!(solver.length(&distances), best, "{count} nodes");
            }
        }
    }

    /// A solver that served a larger tour before finds what a new one finds: nothing stale misleads it.
    #[test]
    fn an_earlier_tour_leaves_no_trace() {
        let mut random = Pcg32::new(8, 8);
        let points: Vec<(f32, f32)> = (0..60).map(|_| (random.uniform(), random.uniform())).collect();
        let distances = EuclideanCells { points: &points, scale: 10_000.0 };
        let mut used = TourSolver::<64>::new(Pcg32::new(1, 1));
        used.start(60, &distances).unwrap();
        let mut new = TourSolver::<64>::new(Pcg32::new(1, 1));
        let order: Vec<u16> = (0..40).collect();
        used.start_from(&order, &distances).unwrap();
        new.start_from(&order, &distances).unwrap();
        assert!(used.order().eq(new.order()));
        let before = new.length(&distances);
        let gained = used.improve(500, &distances);
        assert_eq!(gained, new.improve(500, &distances));
        assert_eq!(before - used.length(&distances), i64::from(gained));
    }

    #[test]
    fn refuses_what_is_no_order() {
        let points = [(0.0, 0.0), (1.0, 0.0), (2.0, 0.0)];
        let distances = EuclideanCells { points: &points, scale: 1.0 };
        let mut solver = TourSolver::<8>::new(Pcg32::new(1, 1));
        for bad in [[0, 1, 1], [1, 0, 2], [0, 1, 7]] {
            assert_eq!(solver.start_from(&bad, &distances), Err(TourError::NotAnOrder));
        }
        assert!(matches!(solver.start(8, &distances), Err(TourError::TooMany { nodes: 8, capacity: 7 })));
        solver.start_from(&[0, 2, 1], &distances).unwrap();
        assert_eq!(solver.order().count(), 3);
    }
}
