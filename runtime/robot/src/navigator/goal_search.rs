//! The global plan: paths that this long robot can drive, across the whole map.

use floorguard_mapping::{GridGeometry, GridSides};
use floorguard_navigation::costmap::CostmapView;
use floorguard_navigation::global::{
    GearOutlines, GlobalPlanner as _, GridSearch, HEADINGS, HeapEntry, Lattice, LatticeCell, LatticeGoal,
    LatticeNode, LatticePlanner, LatticeStorage, Plan, PlanFailure, PlanRequest, StepCosts,
};
use floorguard_types::motion::Waypoint;

use super::model::Model;
use super::plan::Journey;

/// The lattice distinguishes places so finely at least, metres.
const RASTER_MIN_M: f32 = 0.1;
/// Places and headings that a search distinguishes at most.
const KINDS_MAX: usize = 16_000_000;
/// Poses that a search examines at most.
const NODES_MAX: usize = 400_000;
/// Waypoints of a path at most.
const PATH_MAX: usize = 8_192;
/// The lattice comes as near to the goal as this; the rest is the local planner's, metres and radians.
const NEAR_M: f32 = 0.15;
const NEAR_RAD: f32 = 0.22;

type Search = LatticePlanner<Vec<u32>, Vec<u32>, Vec<LatticeNode>, Vec<LatticeCell>, Vec<HeapEntry>>;

/// The planner with its memory.
pub(super) struct GoalSearch {
    search: Search,
    path: Vec<Waypoint>,
    tolerance_m: f32,
    /// With what the guard wants, and where that leads nowhere what the body needs: the guard has the last word, on what stands there
    /// then.
    outlines: [GearOutlines; 2],
}

impl GoalSearch {
    /// Over a costmap's raster.
    ///
    /// # Errors
    /// The raster makes no lattice.
    pub(super) fn new(geometry: &GridGeometry, model: &Model) -> anyhow::Result<Self> {
        let cells = geometry.cell_count();
        let search = GridSearch::new(vec![0; cells], vec![0; cells.max(4_096)], StepCosts::new(false));
        let area_m2 = cells as f32 * geometry.resolution_m() * geometry.resolution_m();
        let finest_m = (area_m2 * HEADINGS as f32 / KINDS_MAX as f32).sqrt();
        let raster_m = RASTER_MIN_M.max(finest_m);
        let side = |count: usize| (count as f32 * geometry.resolution_m() / raster_m).ceil() as u32;
        let sides = GridSides { columns: side(geometry.columns()), rows: side(geometry.rows()) };
        let raster = GridGeometry::with_sides(sides, raster_m, geometry.origin_in_map())
            .ok_or_else(|| anyhow::anyhow!("the map makes no lattice"))?;
        let kinds = raster.cell_count() * HEADINGS;
        let memory = LatticeStorage {
            nodes: vec![LatticeNode::default(); NODES_MAX],
            cells: vec![LatticeCell::default(); kinds],
            heap: vec![HeapEntry::default(); NODES_MAX],
        };
        let lattice = Lattice::new(raster, model.pace(raster_m), memory);
        let tolerance_m = model.arrival.within_m;
        let goal = LatticeGoal {
            within_m: NEAR_M.min(0.8 * tolerance_m),
            within_rad: NEAR_RAD.max(0.8 * model.arrival.within_rad),
            clear_cost: model.clear_cost,
        };
        let search = LatticePlanner::new(search, lattice, model.outlines.clone(), goal);
        let outlines = [model.outlines.clone(), GearOutlines::alike(model.outline.clone())];
        Ok(Self { search, path: vec![Waypoint::default(); PATH_MAX], tolerance_m, outlines })
    }

    /// What a path needs at least: one that the guard may refuse for a moment is no reason to plan anew.
    pub(super) const fn least(&self) -> &GearOutlines {
        &self.outlines[1]
    }

    /// A path between two poses of the map frame. Where there is none, the search is made twice.
    ///
    /// # Errors
    /// See [`PlanFailure`].
    pub(super) fn plan(
        &mut self,
        costmap: CostmapView<'_>,
        journey: Journey,
    ) -> Result<(Plan, Vec<Waypoint>), PlanFailure> {
        let Journey { start_in_map, goal_in_map } = journey;
        let request = PlanRequest { costmap, start_in_map, goal_in_map, tolerance_m: 0.5 * self.tolerance_m };
        let mut found = Err(PlanFailure::Unreachable);
        for outlines in &self.outlines {
            self.search.set_outlines(outlines);
            found = self.search.plan(&request, &mut self.path);
            if found != Err(PlanFailure::Unreachable) {
                break;
            }
        }
        let plan = found?;
        Ok((plan, self.path.get(..plan.waypoints).unwrap_or_default().to_vec()))
    }
}
