//! The lattice from one end of a recorded office to the other.

use floorguard_mapping::{GridGeometry, GridSides, Occupancy};
use floorguard_navigation::costmap::{CostmapView, InflationConfig};
use floorguard_navigation::global::{
    GearOutlines, GlobalPlanner as _, GridSearch, HEADINGS, HeapEntry, Lattice, LatticeCell, LatticeGoal,
    LatticeNode, LatticePlanner, LatticeStorage, Pace, PlanFailure, PlanRequest, SearchMethod, StepCosts,
};
use floorguard_robot::site::ros_map;
use floorguard_types::geometry::Pose2;
use floorguard_types::motion::{Footprint, Waypoint};

use super::navigation::{Floor, NavigationTime, fastest_ms};
use crate::barn::jackal;
use crate::data::recording;

/// Cells of the raster that keeps poses apart, metres.
const RASTER_M: f32 = 0.15;
/// Poses that a search may look at, and waypoints of a path.
const NODES: usize = 400_000;
const WAYPOINTS: usize = 10_000;
/// The path ends within, metres.
const WITHIN_M: f32 = 0.3;
const PACE: Pace = Pace {
    speed_mps: 0.5,
    turn_radps: 0.6,
    reverse_mps: 0.2,
    change_s: 1.0,
    step_m: 0.3,
    arc_m: 0.75,
    haste: 1.3,
};

/// The whole of Willow Garage, with the two places of it that are farthest apart along x and at which the robot can turn.
pub struct Office {
    floor: Floor,
    outline: Footprint,
    clear_cost: u8,
    /// At its left end and at its right end, map frame.
    pub ends: [Pose2; 2],
}

/// A path that was found.
#[derive(Clone, Debug, PartialEq)]
pub struct OfficePath {
    /// What is driven.
    pub path: Vec<Waypoint>,
    /// How long that takes, seconds.
    pub time_s: f32,
    /// Poses that the search looked at.
    pub examined: usize,
}

type OfficePlanner = LatticePlanner<Vec<u32>, Vec<u32>, Vec<LatticeNode>, Vec<LatticeCell>, Vec<HeapEntry>>;

impl Office {
    /// `None`: its map is absent.
    #[must_use]
    pub fn load() -> Option<Self> {
        let map = ros_map::load(&recording("grid_maps/willow-full-0.05.yaml")?).ok()?;
        let geometry = *map.geometry();
        let outline = jackal();
        let shape = InflationConfig {
            inscribed_radius_m: outline.inscribed_radius_m(),
            inflation_radius_m: outline.circumscribed_radius_m() + 0.2,
            decay_per_m: 6.0,
        };
        let clear_cost = shape.cost_at(outline.circumscribed_radius_m() + 0.05);
        // What the map does not show as free floor is an obstacle, as for the navigator.
        let fixed: Vec<Occupancy> = map
            .values()
            .iter()
            .map(|seen| if *seen == Occupancy::Free { Occupancy::Free } else { Occupancy::Occupied })
            .collect();
        let floor = Floor::new(geometry, &fixed, &shape);
        let mut search = GridSearch::new(vec![0; fixed.len()], vec![0; fixed.len()], StepCosts::new(false));
        let middle = (geometry.columns() as i32 / 2, geometry.rows() as i32 / 2);
        search.run(floor.view(), floor.passable_from(middle.0, middle.1), None, SearchMethod::Dijkstra);
        // A point that fits is not enough: the body must.
        let fits = |cell: &usize| search.distance(*cell).is_some() && floor.costs[*cell] < clear_cost;
        let by_x = |cell: &usize| geometry.coordinates(*cell).column;
        let cells = || (0..floor.costs.len()).filter(fits);
        let at = |cell: usize| Pose2::new(geometry.centre(cell).x_m, geometry.centre(cell).y_m, 0.0);
        let ends = [at(cells().min_by_key(by_x)?), at(cells().max_by_key(by_x)?)];
        Some(Self { floor, outline, clear_cost, ends })
    }

    /// What it costs to drive where.
    #[must_use]
    pub fn costmap(&self) -> CostmapView<'_> {
        self.floor.view()
    }

    /// The outline that must be free on the whole path.
    #[must_use]
    pub const fn outline(&self) -> &Footprint {
        &self.outline
    }

    /// A planner for this floor.
    ///
    /// # Panics
    /// Never: the raster is legal.
    fn planner(&self) -> OfficePlanner {
        let raster = coarse(&self.floor.geometry, RASTER_M).expect("a raster");
        let cells = self.floor.costs.len();
        let search = GridSearch::new(vec![0; cells], vec![0; cells], StepCosts::new(false));
        let storage = LatticeStorage {
            nodes: vec![LatticeNode::default(); NODES],
            cells: vec![LatticeCell::default(); raster.cell_count() * HEADINGS],
            heap: vec![HeapEntry::default(); NODES],
        };
        let goal = LatticeGoal { within_m: WITHIN_M, within_rad: 4.0, clear_cost: self.clear_cost };
        let outlines = GearOutlines::alike(self.outline.clone());
        LatticePlanner::new(search, Lattice::new(raster, PACE, storage), outlines, goal)
    }

    fn plan(
        &self,
        planner: &mut OfficePlanner,
        [start_in_map, goal_in_map]: [Pose2; 2],
    ) -> Result<OfficePath, PlanFailure> {
        let request =
            PlanRequest { costmap: self.costmap(), start_in_map, goal_in_map, tolerance_m: WITHIN_M };
        let mut path = vec![Waypoint::default(); WAYPOINTS];
        let plan = planner.plan(&request, &mut path)?;
        path.truncate(plan.waypoints);
        Ok(OfficePath { path, time_s: plan.cost, examined: planner.lattice().examined() })
    }

    /// The path from a pose to another.
    ///
    /// # Errors
    /// There is none.
    pub fn across(&self, from_to: [Pose2; 2]) -> Result<OfficePath, PlanFailure> {
        self.plan(&mut self.planner(), from_to)
    }
}

/// The computing time from the left to the right.
pub(super) fn across_a_building() -> Option<NavigationTime> {
    let office = Office::load()?;
    let mut planner = office.planner();
    let (ms, plan) = fastest_ms(5, || office.plan(&mut planner, office.ends));
    let apart_m = (office.ends[1].x_m - office.ends[0].x_m).hypot(office.ends[1].y_m - office.ends[0].y_m);
    let note = match plan {
        Ok(OfficePath { time_s, examined, .. }) => format!(
            "{apart_m:.0} m apart, {time_s:.0} s of driving, {examined} poses looked at; at most 50 ms"
        ),
        Err(failure) => format!("{failure}"),
    };
    Some(NavigationTime { task: "lattice, across", input: "willow-full".into(), ms, note })
}

/// The same place with larger cells.
fn coarse(geometry: &GridGeometry, edge_m: f32) -> Option<GridGeometry> {
    let side = |cells: usize| (cells as f32 * geometry.resolution_m() / edge_m).ceil() as u32 + 1;
    let sides = GridSides { columns: side(geometry.columns()), rows: side(geometry.rows()) };
    GridGeometry::with_sides(sides, edge_m, geometry.origin_in_map())
}
