//! The bucketed searches as global planners.

use floorguard_mapping::GridCoordinates;
use floorguard_types::geometry::Point2;
use floorguard_types::motion::Waypoint;
use floorguard_types::number::nearest_f32;

use super::contract::{GlobalPlanner, Plan, PlanFailure, PlanRequest};
use super::grid_search::{GridSearch, SearchEnd, SearchMethod};
use super::trace::nearest_cell;

/// A robot that stands too near an obstacle starts from the nearest place where it could stand, if that is this near, metres.
pub(super) const START_REACH_M: f32 = 0.3;

/// Dijkstra or A* over cells; the cost of a plan is in units of 1/50 cell of free floor.
#[derive(Clone, Debug)]
pub struct GridPlanner<D, Q> {
    search: GridSearch<D, Q>,
    method: SearchMethod,
}

impl<D: AsRef<[u32]> + AsMut<[u32]>, Q: AsRef<[u32]> + AsMut<[u32]>> GridPlanner<D, Q> {
    /// Plans with a search.
    #[must_use]
    pub const fn new(search: GridSearch<D, Q>, method: SearchMethod) -> Self {
        Self { search, method }
    }

    /// The search with the distances of the last plan.
    #[must_use]
    pub const fn search(&self) -> &GridSearch<D, Q> {
        &self.search
    }
}

impl<D: AsRef<[u32]> + AsMut<[u32]>, Q: AsRef<[u32]> + AsMut<[u32]>> GlobalPlanner for GridPlanner<D, Q> {
    fn plan(&mut self, request: &PlanRequest<'_>, path: &mut [Waypoint]) -> Result<Plan, PlanFailure> {
        let costmap = request.costmap;
        let geometry = costmap.geometry();
        let place = |pose: floorguard_types::geometry::Pose2| Point2::new(pose.x_m, pose.y_m);
        let steps = self.search.steps();
        let can_stand = |cell: usize| {
            let GridCoordinates { column, row } = geometry.coordinates(cell);
            let columns = i32::try_from(geometry.columns()).unwrap_or(i32::MAX);
            let rows = i32::try_from(geometry.rows()).unwrap_or(i32::MAX);
            let is_inner =
                column > 0 && row > 0 && column < columns.saturating_sub(1) && row < rows.saturating_sub(1);
            let cost = costmap.costs().get(cell).copied().unwrap_or(u8::MAX);
            is_inner && steps.straight(cost) > 0
        };
        let start = nearest_cell(geometry, place(request.start_in_map), START_REACH_M, can_stand);
        let start = start.ok_or(PlanFailure::StartBlocked)?;
        let goal_in_map = place(request.goal_in_map);
        let goal = nearest_cell(geometry, goal_in_map, request.tolerance_m, can_stand);
        let goal = goal.ok_or(PlanFailure::GoalBlocked)?;
        let goal = match self.search.run(costmap, start, Some(goal), self.method) {
            SearchEnd::Reached => goal,
            SearchEnd::OutOfRoom => return Err(PlanFailure::OutOfRoom),
            SearchEnd::Exhausted => {
                let is_reached = |cell: usize| self.search.distance(cell).is_some();
                nearest_cell(geometry, goal_in_map, request.tolerance_m, is_reached)
                    .ok_or(PlanFailure::Unreachable)?
            }
        };
        let waypoints = self.search.trace(costmap, goal, path)?;
        let cost = nearest_f32(self.search.distance(goal).unwrap_or(0));
        Ok(Plan { waypoints, cost, costmap_revision: costmap.revision() })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::costmap::{CostmapView, Costs};
    use crate::global::StepCosts;
    use floorguard_mapping::{GridGeometry, GridSides};
    use floorguard_types::geometry::Pose2;
    use floorguard_types::random::Pcg32;
    use proptest::prelude::*;
    use std::vec;
    use std::vec::Vec;

    /// All distances by sweeps of relaxation until nothing changes (Bellman and Ford), written from the definition.
    fn exhaustive(view: CostmapView<'_>, start: usize) -> Vec<Option<u32>> {
        let geometry = view.geometry();
        let (columns, rows) = (geometry.columns() as i32, geometry.rows() as i32);
        let weight = |x: i32, y: i32| {
            let inner = x > 0 && y > 0 && x < columns - 1 && y < rows - 1;
            let cost = u32::from(view.cost(x, y));
            (inner && cost < 253).then_some(3 * cost + 50)
        };
        let mut all = vec![None; geometry.cell_count()];
        all[start] = Some(0_u32);
        let mut changed = true;
        while changed {
            changed = false;
            for cell in 0..all.len() {
                let Some(here) = all[cell] else { continue };
                let GridCoordinates { column: x, row: y } = geometry.coordinates(cell);
                for (dx, dy) in [(1, 0), (-1, 0), (0, 1), (0, -1), (1, 1), (-1, 1), (1, -1), (-1, -1)] {
                    let Some(step) = weight(x + dx, y + dy) else { continue };
                    let diagonal = dx != 0 && dy != 0;
                    if diagonal && (weight(x + dx, y).is_none() || weight(x, y + dy).is_none()) {
                        continue;
                    }
                    let next = here + if diagonal { step * 181 / 128 } else { step };
                    let other = geometry.index(x + dx, y + dy).unwrap();
                    if all[other].is_none_or(|old| next < old) {
                        all[other] = Some(next);
                        changed = true;
                    }
                }
            }
        }
        all
    }

    fn random_costs(random: &mut Pcg32, count: usize, walls: f32) -> Vec<u8> {
        let cost = |random: &mut Pcg32| {
            if random.bernoulli(walls) {
                [Costs::INSCRIBED, Costs::LETHAL, Costs::UNKNOWN][random.below(3) as usize]
            } else if random.bernoulli(0.5) {
                0
            } else {
                random.below(253) as u8
            }
        };
        (0..count).map(|_| cost(random)).collect()
    }

    proptest! {
        #[test]
        fn dijkstra_and_a_star_are_optimal(
            columns in 3_u32..24, rows in 3_u32..24, seed in any::<u64>(), walls in 0.0_f32..0.45,
        ) {
            let sides = GridSides { columns, rows };
            let geometry = GridGeometry::with_sides(sides, 0.1, Point2::default()).unwrap();
            let count = geometry.cell_count();
            let mut random = Pcg32::new(seed, 3);
            let costs = random_costs(&mut random, count, walls);
            let view = CostmapView::new(geometry, &costs, 1).unwrap();
            let start = geometry.index(1 + random.below(columns - 2) as i32, 1 + random.below(rows - 2) as i32).unwrap();
            let expected = exhaustive(view, start);
            let mut search = GridSearch::new(vec![0; count], vec![0; 8 * count + 4_096], StepCosts::new(false));
            prop_assert_eq!(search.run(view, start, None, SearchMethod::Dijkstra), SearchEnd::Exhausted);
            for (cell, length) in expected.iter().enumerate() {
                prop_assert_eq!(search.distance(cell), *length, "cell {}", cell);
            }
            for _ in 0..8 {
                let goal = random.below(count as u32) as usize;
                for method in [SearchMethod::Dijkstra, SearchMethod::AStar] {
                    let end = search.run(view, start, Some(goal), method);
                    prop_assert_eq!(end == SearchEnd::Reached, expected[goal].is_some());
                    prop_assert_eq!(search.distance(goal), expected[goal]);
                    if let Some(length) = expected[goal] {
                        let mut path = vec![Waypoint::default(); count];
                        let waypoints = search.trace(view, goal, &mut path).unwrap();
                        prop_assert_eq!(cost_of(view, &path[..waypoints]), length);
                    }
                }
            }
        }
    }

    /// Cost of a traced path, step by step.
    fn cost_of(view: CostmapView<'_>, path: &[Waypoint]) -> u32 {
        let cells: Vec<usize> =
            path.iter().map(|at| view.geometry().cell_at(at.place_in_map()).unwrap()).collect();
        let steps = cells.windows(2).map(|pair| {
            let [from, to] = [pair[0], pair[1]].map(|cell| view.geometry().coordinates(cell));
            assert!((from.column - to.column).abs() <= 1 && (from.row - to.row).abs() <= 1);
            let step = 3 * u32::from(view.cost(to.column, to.row)) + 50;
            if from.column != to.column && from.row != to.row { step * 181 / 128 } else { step }
        });
        steps.sum()
    }

    fn plan(costs: &[u8], start: Pose2, goal: Pose2, room: usize) -> Result<Plan, PlanFailure> {
        let geometry = GridGeometry::new(20, 10, 0.1, Point2::default()).unwrap();
        let costmap = CostmapView::new(geometry, costs, 7).unwrap();
        let search = GridSearch::new(vec![0; 200], vec![0; 4_096], StepCosts::new(false));
        let mut planner = GridPlanner::new(search, SearchMethod::AStar);
        let request = PlanRequest { costmap, start_in_map: start, goal_in_map: goal, tolerance_m: 0.25 };
        planner.plan(&request, &mut vec![Waypoint::default(); room])
    }

    #[test]
    fn blocked_ends_move_nearby_or_are_refused() {
        let mut costs = vec![0; 200];
        for row in 0..10 {
            costs[row * 20 + 10] = Costs::LETHAL;
        }
        let (left, wall, right) =
            (Pose2::new(0.25, 0.45, 0.0), Pose2::new(1.05, 0.45, 0.0), Pose2::new(1.75, 0.45, 0.0));
        let found = plan(&costs, left, wall, 200).unwrap();
        assert_eq!((found.waypoints, found.cost, found.costmap_revision), (8, 350.0, 7));
        assert!(plan(&costs, wall, left, 200).is_ok());
        assert_eq!(plan(&costs, left, right, 200), Err(PlanFailure::Unreachable));
        assert_eq!(plan(&costs, left, wall, 5), Err(PlanFailure::PathTooLong(8)));
        assert_eq!(plan(&costs, left, left, 5).unwrap().waypoints, 1);
        let outside = Pose2::new(-3.0, 0.0, 0.0);
        assert_eq!(plan(&costs, outside, left, 5), Err(PlanFailure::StartBlocked));
        assert_eq!(plan(&costs, left, outside, 5), Err(PlanFailure::GoalBlocked));
    }

    #[test]
    fn missing_room_is_a_value() {
        let geometry = GridGeometry::new(20, 10, 0.1, Point2::default()).unwrap();
        let costs = vec![0; 200];
        let view = CostmapView::new(geometry, &costs, 1).unwrap();
        let mut small = GridSearch::new(vec![0; 199], vec![0; 4_096], StepCosts::new(false));
        assert_eq!(small.run(view, 25, None, SearchMethod::Dijkstra), SearchEnd::OutOfRoom);
        let mut short = GridSearch::new(vec![0; 200], vec![0; 40], StepCosts::new(false));
        assert_eq!(short.run(view, 25, None, SearchMethod::Dijkstra), SearchEnd::OutOfRoom);
    }
}
