//! The lattice as a global planner: on the costmap the outline that each gear needs, and the shortest path of a point as its estimate.

use floorguard_types::geometry::{Point2, Pose2, wrap_angle};
use floorguard_types::motion::{Gear, Waypoint};
use floorguard_types::number::nearest_f32;

use super::contract::{GlobalPlanner, Plan, PlanFailure, PlanRequest};
use super::gear_outlines::GearOutlines;
use super::grid_planner::START_REACH_M;
use super::grid_search::{GridSearch, SearchEnd, SearchMethod};
use super::lattice::{Lattice, LatticeCell, LatticeNode, LatticeWorld};
use super::lattice_heap::HeapEntry;
use super::lattice_motions::Pace;
use super::step_costs::StepCosts;
use super::trace::nearest_cell;
use crate::costmap::{CostmapView, Costs, footprint_cost};

/// When the goal counts as reached.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LatticeGoal {
    /// Within this distance, metres, of the goal or of the nearest place to it where the robot can stand.
    pub within_m: f32,
    /// Within this angle, radians; π or more: any heading.
    pub within_rad: f32,
    /// Below this cost nothing touches the circumscribed disc of the outline that backs: it need not be examined.
    pub clear_cost: u8,
}

/// Paths that the drive can make for the true outline; the cost of a plan is in seconds.
#[derive(Clone, Debug)]
pub struct LatticePlanner<D, Q, N, C, H> {
    search: GridSearch<D, Q>,
    lattice: Lattice<N, C, H>,
    outlines: GearOutlines,
    goal: LatticeGoal,
}

impl<D, Q, N, C, H> LatticePlanner<D, Q, N, C, H>
where
    D: AsRef<[u32]> + AsMut<[u32]>,
    Q: AsRef<[u32]> + AsMut<[u32]>,
    N: AsRef<[LatticeNode]> + AsMut<[LatticeNode]>,
    C: AsRef<[LatticeCell]> + AsMut<[LatticeCell]>,
    H: AsRef<[HeapEntry]> + AsMut<[HeapEntry]>,
{
    /// From a search for the estimate and a lattice.
    #[must_use]
    pub const fn new(
        search: GridSearch<D, Q>,
        lattice: Lattice<N, C, H>,
        outlines: GearOutlines,
        goal: LatticeGoal,
    ) -> Self {
        Self { search, lattice, outlines, goal }
    }

    /// Other outlines from now on.
    pub fn set_outlines(&mut self, outlines: &GearOutlines) {
        self.outlines.clone_from(outlines);
    }

    /// The lattice, for its counters.
    #[must_use]
    pub const fn lattice(&self) -> &Lattice<N, C, H> {
        &self.lattice
    }
}

/// What the lattice sees of a costmap.
struct World<'a, D, Q> {
    costmap: CostmapView<'a>,
    outlines: &'a GearOutlines,
    search: &'a GridSearch<D, Q>,
    pace: Pace,
    goal: LatticeGoal,
    goal_in_map: Pose2,
    within_m: f32,
}

impl<D: AsRef<[u32]> + AsMut<[u32]>, Q: AsRef<[u32]> + AsMut<[u32]>> LatticeWorld for World<'_, D, Q> {
    fn slowness(&self, pose_in_map: Pose2, gear: Gear) -> Option<f32> {
        let cost = self.costmap.cost_at(Point2::new(pose_in_map.x_m, pose_in_map.y_m));
        if cost >= Costs::INSCRIBED {
            return None;
        }
        let outline = self.outlines.of(gear);
        let reaches_out = outline.circumscribed_radius_m() > self.outlines.back.circumscribed_radius_m();
        if cost >= self.goal.clear_cost || reaches_out {
            footprint_cost(self.costmap, outline, pose_in_map).ok()?;
        }
        Some(1.0 + 3.0 * f32::from(cost) / nearest_f32(StepCosts::NEUTRAL))
    }

    fn left_s(&self, pose_in_map: Pose2) -> Option<f32> {
        let geometry = self.costmap.geometry();
        let cell = geometry.cell_at(Point2::new(pose_in_map.x_m, pose_in_map.y_m))?;
        let cells = nearest_f32(self.search.distance(cell)?) / nearest_f32(StepCosts::NEUTRAL);
        Some(cells * geometry.resolution_m() / self.pace.speed_mps)
    }

    fn is_goal(&self, pose_in_map: Pose2) -> bool {
        let place = Point2::new(pose_in_map.x_m, pose_in_map.y_m);
        let turn_rad = wrap_angle(pose_in_map.heading_rad - self.goal_in_map.heading_rad);
        place.distance(Point2::new(self.goal_in_map.x_m, self.goal_in_map.y_m)) <= self.within_m
            && libm::fabsf(turn_rad) <= self.goal.within_rad
    }
}

impl<D, Q, N, C, H> GlobalPlanner for LatticePlanner<D, Q, N, C, H>
where
    D: AsRef<[u32]> + AsMut<[u32]>,
    Q: AsRef<[u32]> + AsMut<[u32]>,
    N: AsRef<[LatticeNode]> + AsMut<[LatticeNode]>,
    C: AsRef<[LatticeCell]> + AsMut<[LatticeCell]>,
    H: AsRef<[HeapEntry]> + AsMut<[HeapEntry]>,
{
    fn plan(&mut self, request: &PlanRequest<'_>, path: &mut [Waypoint]) -> Result<Plan, PlanFailure> {
        let costmap = request.costmap;
        let geometry = costmap.geometry();
        let can_stand = |cell: usize| {
            let cost = costmap.costs().get(cell).copied().unwrap_or(u8::MAX);
            self.search.steps().straight(cost) > 0
        };
        let place = |pose: Pose2| Point2::new(pose.x_m, pose.y_m);
        let goal = nearest_cell(geometry, place(request.goal_in_map), request.tolerance_m, can_stand);
        let goal = goal.ok_or(PlanFailure::GoalBlocked)?;
        let start = nearest_cell(geometry, place(request.start_in_map), START_REACH_M, can_stand);
        let start = start.ok_or(PlanFailure::StartBlocked)?;
        // From the goal outwards: afterwards every place knows how far the goal is.
        match self.search.run(costmap, goal, Some(start), SearchMethod::Dijkstra) {
            SearchEnd::OutOfRoom => return Err(PlanFailure::OutOfRoom),
            SearchEnd::Exhausted => return Err(PlanFailure::Unreachable),
            SearchEnd::Reached => {}
        }
        let is_own = geometry.cell_at(place(request.goal_in_map)) == Some(goal);
        let moved_m = if is_own { 0.0 } else { geometry.centre(goal).distance(place(request.goal_in_map)) };
        let world = World {
            costmap,
            outlines: &self.outlines,
            search: &self.search,
            pace: *self.lattice.pace(),
            goal: self.goal,
            goal_in_map: request.goal_in_map,
            within_m: self.goal.within_m + moved_m,
        };
        let found = self.lattice.find(request.start_in_map, &world, path)?;
        Ok(Plan { waypoints: found.waypoints, cost: found.time_s, costmap_revision: costmap.revision() })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::costmap::InflationConfig;
    use crate::costmap::floor_tests::costs_of;
    use crate::global::{HEADINGS, LatticeStorage};
    use floorguard_mapping::GridGeometry;
    use floorguard_types::motion::Footprint;
    use std::vec;
    use std::vec::Vec;

    const PACE: Pace = Pace {
        speed_mps: 0.5,
        turn_radps: 0.6,
        reverse_mps: 0.2,
        change_s: 1.0,
        step_m: 0.15,
        arc_m: 0.75,
        haste: 1.3,
    };

    /// A robot of 1.2 m × 0.5 m through a gap of 0.8 m, to a goal that it must reach backwards out of a pocket otherwise.
    #[test]
    fn long_robot_passes_gap_with_whole_outline() {
        let geometry = GridGeometry::new(160, 120, 0.05, Point2::default()).unwrap();
        let shape = InflationConfig { inscribed_radius_m: 0.25, inflation_radius_m: 0.9, decay_per_m: 4.0 };
        let costs = costs_of(&geometry, &shape, |place| {
            let is_wall = (place.x_m - 4.0).abs() < 0.1 && !(4.0..4.8).contains(&place.y_m);
            is_wall || place.x_m < 0.1 || place.y_m < 0.1 || place.x_m > 7.9 || place.y_m > 5.9
        });
        let costmap = CostmapView::new(geometry, &costs, 1).unwrap();
        let corners = [(0.9, 0.25), (-0.3, 0.25), (-0.3, -0.25), (0.9, -0.25)];
        let footprint = Footprint::new(&corners.map(|(x, y)| Point2::new(x, y))).unwrap();
        let search = GridSearch::new(vec![0; costs.len()], vec![0; 8_192], StepCosts::new(false));
        let raster = GridGeometry::new(80, 60, 0.1, Point2::default()).unwrap();
        let storage = LatticeStorage {
            nodes: vec![LatticeNode::default(); 60_000],
            cells: vec![LatticeCell::default(); raster.cell_count() * HEADINGS],
            heap: vec![HeapEntry::default(); 60_000],
        };
        let lattice = Lattice::new(raster, PACE, storage);
        let goal = LatticeGoal { within_m: 0.2, within_rad: 0.3, clear_cost: 1 };
        let mut planner = LatticePlanner::new(search, lattice, GearOutlines::alike(footprint.clone()), goal);
        let request = PlanRequest {
            costmap,
            start_in_map: Pose2::new(1.0, 1.0, 0.0),
            goal_in_map: Pose2::new(6.5, 1.2, 0.0),
            tolerance_m: 0.1,
        };
        let mut path = vec![Waypoint::default(); 500];
        let plan = planner.plan(&request, &mut path).unwrap();
        let path: Vec<Waypoint> = path[..plan.waypoints].to_vec();
        assert_eq!(path[0].pose_in_map, request.start_in_map);
        let last = path.last().unwrap();
        assert!(last.place_in_map().distance(Point2::new(6.5, 1.2)) <= 0.21);
        assert!(last.pose_in_map.heading_rad.abs() <= 0.3 + 1e-4);
        assert!(path.iter().any(|at| at.pose_in_map.y_m > 3.9));
        for at in &path[1..] {
            assert!(footprint_cost(costmap, &footprint, at.pose_in_map).is_ok(), "{at:?}");
        }
        let far = PlanRequest { goal_in_map: Pose2::new(4.0, 1.0, 0.0), ..request };
        assert_eq!(planner.plan(&far, &mut vec![Waypoint::default(); 500]), Err(PlanFailure::GoalBlocked));
    }

    /// Before a wall a robot whose guard wants room ahead goes back first; its body alone could turn where it stands.
    #[test]
    fn robot_parked_before_a_wall_backs_first() {
        let geometry = GridGeometry::new(120, 120, 0.05, Point2::default()).unwrap();
        let shape = InflationConfig { inscribed_radius_m: 0.25, inflation_radius_m: 0.9, decay_per_m: 4.0 };
        let costs = costs_of(&geometry, &shape, |place| {
            place.x_m < 0.1 || place.y_m < 0.1 || place.x_m > 5.9 || place.y_m > 5.9
        });
        let outline = |reach_m: f32| {
            let corners = [(reach_m, 0.25), (-0.3, 0.25), (-0.3, -0.25), (reach_m, -0.25)];
            Footprint::new(&corners.map(|(x, y)| Point2::new(x, y))).unwrap()
        };
        let raster = GridGeometry::new(60, 60, 0.1, Point2::default()).unwrap();
        let request = PlanRequest {
            costmap: CostmapView::new(geometry, &costs, 1).unwrap(),
            start_in_map: Pose2::new(4.7, 3.0, 0.0),
            goal_in_map: Pose2::new(2.0, 3.0, core::f32::consts::PI),
            tolerance_m: 0.1,
        };
        let first_gear = |reach_m: f32| {
            let search = GridSearch::new(vec![0; costs.len()], vec![0; 8_192], StepCosts::new(false));
            let storage = LatticeStorage {
                nodes: vec![LatticeNode::default(); 60_000],
                cells: vec![LatticeCell::default(); raster.cell_count() * HEADINGS],
                heap: vec![HeapEntry::default(); 60_000],
            };
            let goal = LatticeGoal { within_m: 0.2, within_rad: 0.3, clear_cost: 1 };
            let alike = GearOutlines::alike(outline(0.9));
            let mut planner = LatticePlanner::new(search, Lattice::new(raster, PACE, storage), alike, goal);
            planner.set_outlines(&GearOutlines { ahead: outline(reach_m), back: outline(0.9) });
            let mut path = vec![Waypoint::default(); 500];
            let plan = planner.plan(&request, &mut path).unwrap();
            assert!(plan.waypoints > 2);
            path[1].gear
        };
        assert_eq!((first_gear(0.9), first_gear(1.3)), (Gear::Spin, Gear::Back));
    }
}
