//! Frontiers of a costmap, as ROS `explore_lite` finds them, with its defects mended.
//!
//! Published: the cell where a frontier was met counts for its size and not for the sum of its centroid, which moves small
//! frontiers towards the origin; the least distance leaves that cell out; the goal is the centroid, which can lie in an
//! obstacle or in the unknown. Here all cells count, and the goal is the free cell beside the frontier that is nearest to the
//! centroid.

use floorguard_mapping::{GRID_CELLS_MAX, GridCoordinates, GridGeometry};
use floorguard_types::geometry::Point2;
use floorguard_types::number::{exact_usize, nearest_f32_of_f64, nearest_f64, truncating_u32};
use heapless::Vec;

use crate::costmap::{CostmapView, Costs};

/// Frontiers kept; the smallest is dropped first and counted.
pub const FRONTIERS_MAX: usize = 128;
const UNSEEN: u8 = 0;
/// The robot gets there over known floor.
const FLOOR: u8 = 1;
/// Belongs to a frontier.
const USED: u8 = 2;

/// A connected border of known floor.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Frontier {
    /// Unknown cells that it consists of.
    pub cells: u32,
    /// Mean of their centres, in the map frame.
    pub centroid_in_map: Point2,
    /// A free cell beside it, nearest to the centroid: where to go.
    pub goal_in_map: Point2,
    /// From the robot to the nearest cell, metres, in a straight line.
    pub nearest_m: f32,
}

/// Storage: both one entry a cell.
pub struct FrontierScratch<'a> {
    /// What is known of a cell.
    pub states: &'a mut [u8],
    /// Cells that wait.
    pub queue: &'a mut [u32],
}

/// What was found.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct FrontierSearch {
    /// The frontiers, in the order in which the search met them.
    pub frontiers: Vec<Frontier, FRONTIERS_MAX>,
    /// Frontiers beyond the capacity.
    pub dropped: u32,
    /// The robot stands on no known floor, nor does anything within reach of it.
    pub is_lost: bool,
    /// The scratch is smaller than the costmap.
    pub is_out_of_room: bool,
}

/// All frontiers that the robot reaches over floor cheaper than an inscribed obstacle, with at least `cells_min` cells. Cost:
/// a few looks at every known cell.
#[must_use]
pub fn find_frontiers(
    costmap: CostmapView<'_>,
    robot_in_map: Point2,
    cells_min: u32,
    scratch: &mut FrontierScratch<'_>,
) -> FrontierSearch {
    let mut found = FrontierSearch::default();
    let count = costmap.geometry().cell_count();
    let (Some(states), Some(queue)) = (scratch.states.get_mut(..count), scratch.queue.get_mut(..count))
    else {
        return FrontierSearch { is_out_of_room: true, ..found };
    };
    states.fill(UNSEEN);
    let is_floor = |cell: usize| costmap.costs().get(cell).is_some_and(|&cost| cost < Costs::INSCRIBED);
    let Some(start) = nearest_floor(costmap.geometry(), robot_in_map, is_floor) else {
        return FrontierSearch { is_lost: true, ..found };
    };
    let mut walk = Walk { costmap, states, queue, robot_in_map };
    let mut filled = walk.enter(start, FLOOR, 0);
    for at in 0..count.min(GRID_CELLS_MAX) {
        if at >= filled {
            break;
        }
        let Some(cell) = walk.queue.get(at).map(|&cell| exact_usize(cell)) else { break };
        for other in straight_neighbours(costmap.geometry(), cell).into_iter().flatten() {
            if walk.state(other) != UNSEEN {
                continue;
            }
            if is_floor(other) {
                filled = walk.enter(other, FLOOR, filled);
            } else if walk.is_border(other) {
                // The frontier grows in the free end of the queue, and leaves it again.
                let frontier = walk.grow(other, filled);
                if frontier.cells >= cells_min {
                    keep(&mut found, frontier);
                }
            }
        }
    }
    found
}

/// Where the robot is, or the nearest floor within two metres.
fn nearest_floor(geometry: &GridGeometry, place: Point2, is_floor: impl Fn(usize) -> bool) -> Option<usize> {
    crate::global::nearest_cell(geometry, place, 2.0, is_floor)
}

fn keep(found: &mut FrontierSearch, frontier: Frontier) {
    if found.frontiers.push(frontier).is_ok() {
        return;
    }
    found.dropped = found.dropped.saturating_add(1);
    let smallest = found.frontiers.iter_mut().min_by_key(|kept| kept.cells);
    if let Some(smallest) = smallest.filter(|kept| kept.cells < frontier.cells) {
        *smallest = frontier;
    }
}

struct Walk<'w, 'c> {
    costmap: CostmapView<'c>,
    states: &'w mut [u8],
    queue: &'w mut [u32],
    robot_in_map: Point2,
}

impl Walk<'_, '_> {
    fn state(&self, cell: usize) -> u8 {
        self.states.get(cell).copied().unwrap_or(USED)
    }

    /// Marks a cell and puts it at the end of the queue; gives the new end.
    fn enter(&mut self, cell: usize, state: u8, filled: usize) -> usize {
        let (Some(mark), Some(slot)) = (self.states.get_mut(cell), self.queue.get_mut(filled)) else {
            return filled;
        };
        *mark = state;
        *slot = truncating_u32(cell);
        filled.saturating_add(1)
    }

    /// Unknown, not yet used, beside free floor.
    fn is_border(&self, cell: usize) -> bool {
        let cost = |cell: usize| self.costmap.costs().get(cell).copied();
        cost(cell) == Some(Costs::UNKNOWN)
            && self.state(cell) == UNSEEN
            && straight_neighbours(self.costmap.geometry(), cell)
                .into_iter()
                .flatten()
                .any(|other| cost(other).is_some_and(|cost| cost < Costs::INSCRIBED))
    }

    /// The frontier around its first cell, over eight neighbours.
    fn grow(&mut self, first: usize, begin: usize) -> Frontier {
        let geometry = *self.costmap.geometry();
        let mut end = self.enter(first, USED, begin);
        let (mut sum_x_m, mut sum_y_m) = (0.0_f64, 0.0_f64);
        let mut nearest_m = f32::INFINITY;
        for at in begin..self.queue.len() {
            if at >= end {
                break;
            }
            let Some(cell) = self.queue.get(at).map(|&cell| exact_usize(cell)) else { break };
            let centre = geometry.centre(cell);
            sum_x_m += f64::from(centre.x_m);
            sum_y_m += f64::from(centre.y_m);
            nearest_m = nearest_m.min(centre.distance(self.robot_in_map));
            let GridCoordinates { column, row } = geometry.coordinates(cell);
            for (dx, dy) in [(1, 0), (-1, 0), (0, 1), (0, -1), (1, 1), (-1, 1), (1, -1), (-1, -1)] {
                let other = geometry.index(column.wrapping_add(dx), row.wrapping_add(dy));
                if let Some(other) = other.filter(|&other| self.is_border(other)) {
                    end = self.enter(other, USED, end);
                }
            }
        }
        let cells = end.saturating_sub(begin);
        let share = 1.0 / nearest_f64(cells.max(1));
        let centroid_in_map =
            Point2::new(nearest_f32_of_f64(sum_x_m * share), nearest_f32_of_f64(sum_y_m * share));
        let goal_in_map = self.goal(begin, cells, centroid_in_map);
        Frontier { cells: truncating_u32(cells), centroid_in_map, goal_in_map, nearest_m }
    }

    /// The free cell beside the frontier that is nearest to its centroid.
    fn goal(&self, begin: usize, cells: usize, centroid_in_map: Point2) -> Point2 {
        let geometry = self.costmap.geometry();
        let border = self.queue.iter().skip(begin).take(cells);
        let beside = border.flat_map(|&cell| straight_neighbours(geometry, exact_usize(cell))).flatten();
        let free = beside
            .filter(|&cell| self.costmap.costs().get(cell).is_some_and(|&cost| cost < Costs::INSCRIBED));
        let distance_m = |cell: &usize| geometry.centre(*cell).distance(centroid_in_map);
        let nearest = free.min_by(|a, b| distance_m(a).total_cmp(&distance_m(b)));
        nearest.map_or(centroid_in_map, |cell| geometry.centre(cell))
    }
}

fn straight_neighbours(geometry: &GridGeometry, cell: usize) -> [Option<usize>; 4] {
    let GridCoordinates { column, row } = geometry.coordinates(cell);
    [(1, 0), (-1, 0), (0, 1), (0, -1)]
        .map(|(dx, dy)| geometry.index(column.wrapping_add(dx), row.wrapping_add(dy)))
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;
    use std::collections::BTreeSet;
    use std::vec;

    fn search(geometry: GridGeometry, costs: &[u8], robot: Point2, cells_min: u32) -> FrontierSearch {
        let view = CostmapView::new(geometry, costs, 0).unwrap();
        let (mut states, mut queue) = (vec![0; costs.len()], vec![0; costs.len()]);
        let mut scratch = FrontierScratch { states: &mut states, queue: &mut queue };
        find_frontiers(view, robot, cells_min, &mut scratch)
    }

    /// Three cells at x = 10.05, 10.15 and 10.25 m: the published sum gives 6.80, the true mean is 10.15.
    #[test]
    fn the_centroid_counts_every_cell() {
        let geometry = GridGeometry::new(200, 5, 0.1, Point2::default()).unwrap();
        let mut costs = vec![Costs::LETHAL; 1_000];
        for column in 90..110 {
            costs[2 * 200 + column] = 0;
        }
        for column in 100..103 {
            costs[3 * 200 + column] = Costs::UNKNOWN;
        }
        let found = search(geometry, &costs, Point2::new(9.55, 0.25), 1);
        assert_eq!(found.frontiers.len(), 1);
        let frontier = found.frontiers[0];
        assert_eq!(frontier.cells, 3);
        assert!((frontier.centroid_in_map.x_m - 10.15).abs() < 1e-4);
        assert!(
            (frontier.goal_in_map.x_m - 10.15).abs() < 1e-4 && (frontier.goal_in_map.y_m - 0.25).abs() < 1e-4
        );
        assert!((frontier.nearest_m - Point2::new(0.5, 0.1).norm()).abs() < 1e-4);
        assert!(search(geometry, &costs, Point2::new(9.55, 0.25), 4).frontiers.is_empty());
        assert!(search(geometry, &costs, Point2::new(1.0, 0.25), 1).is_lost);
    }

    proptest! {
        /// Against the definition: the unknown cells beside floor that is connected with the robot's, grouped by contact.
        #[test]
        fn frontiers_are_the_components_of_the_definition(seed in any::<u64>(), walls in 0.0_f32..0.5) {
            let geometry = GridGeometry::new(24, 18, 0.1, Point2::default()).unwrap();
            let mut random = floorguard_types::random::Pcg32::new(seed, 1);
            let mut costs: vec::Vec<u8> = (0..432)
                .map(|_| if random.bernoulli(walls) { [254, 255][random.below(2) as usize] } else { 0 })
                .collect();
            costs[200] = 0;
            let cost = |x: i32, y: i32| geometry.index(x, y).map(|cell| costs[cell]);
            let around = |cell: usize, reach: i32| {
                let GridCoordinates { column: x, row: y } = geometry.coordinates(cell);
                let offsets = [(1, 0), (-1, 0), (0, 1), (0, -1), (1, 1), (-1, 1), (1, -1), (-1, -1)];
                offsets.into_iter().take(reach as usize)
                    .filter_map(|(dx, dy)| geometry.index(x + dx, y + dy)).collect::<vec::Vec<_>>()
            };
            let spread = |start: usize, is_in: &dyn Fn(usize) -> bool, reach: i32| {
                let (mut set, mut open) = (BTreeSet::from([start]), vec![start]);
                while let Some(cell) = open.pop() {
                    for other in around(cell, reach) {
                        if is_in(other) && set.insert(other) {
                            open.push(other);
                        }
                    }
                }
                set
            };
            let floor = spread(200, &|cell| costs[cell] < 253, 4);
            let any_floor = |cell: usize| around(cell, 4).iter().any(|&other| costs[other] < 253);
            let is_border = |cell: usize| costs[cell] == 255 && any_floor(cell);
            let mut expected: BTreeSet<BTreeSet<usize>> = BTreeSet::new();
            for cell in 0..432 {
                if is_border(cell) && around(cell, 4).iter().any(|other| floor.contains(other)) {
                    expected.insert(spread(cell, &is_border, 8));
                }
            }
            prop_assert!(cost(0, 0).is_some());
            let found = search(geometry, &costs, geometry.centre(200), 1);
            let sizes = |mut all: vec::Vec<usize>| { all.sort_unstable(); all };
            prop_assert_eq!(
                sizes(found.frontiers.iter().map(|frontier| frontier.cells as usize).collect()),
                sizes(expected.iter().map(BTreeSet::len).collect())
            );
        }
    }
}
