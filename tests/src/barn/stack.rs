//! What drives: scan → costmap → path → local planner.

use floorguard_mapping::{GridGeometry, Occupancy, Parabola};
use floorguard_navigation::costmap::{
    Beam, CostmapLayers, CostmapView, Inflation, InflationConfig, InflationScratch, ObstacleLayer,
    ObstacleLimits, PeopleCost, compose,
};
use floorguard_navigation::global::{
    GlobalPlanner as _, GridPlanner, GridSearch, PlanRequest, SearchMethod, StepCosts, smooth,
};
use floorguard_navigation::local::{
    Arrival, Dwa, DwaConfig, DwaScratch, LocalCommand, LocalPlanner, LocalSituation, LocalVerdict, Mppi,
    MppiConfig, MppiSample, MppiWeights, StepCell,
};
use floorguard_types::geometry::{Point2, Pose2, Twist2};
use floorguard_types::motion::{AlwaysPermitted, Waypoint};

use super::recovery::Recovery;
use super::robot::{DRIVE, Which, jackal};
use super::world::World;

/// Cells of the costmap, metres: 10 m × 16 m around start and goal.
const CELL_M: f32 = 0.05;
const SIDES: (u16, u16) = (200, 320);
const CORNER: (f32, f32) = (-7.0, 0.0);
/// From command to command, seconds.
pub(super) const PERIOD_S: f32 = 0.05;
/// Samples of ours.
const SAMPLES: usize = 1_000;

/// Everything between scanner and drive.
pub(super) struct Stack {
    geometry: GridGeometry,
    layer: ObstacleLayer<Vec<Occupancy>>,
    fixed: Vec<Occupancy>,
    inflation: Inflation,
    costs: Vec<u8>,
    squared_cells: Vec<u32>,
    envelope: Vec<Parabola>,
    planner: GridPlanner<Vec<u32>, Vec<u32>>,
    path: Vec<Waypoint>,
    local: Box<dyn LocalPlanner>,
    recovery: Recovery,
    revision: u32,
}

impl Stack {
    /// # Panics
    /// Never: the sizes fit each other.
    pub(super) fn new(which: Which, seed: u64) -> Self {
        let geometry =
            GridGeometry::new(SIDES.0, SIDES.1, CELL_M, Point2::new(CORNER.0, CORNER.1)).expect("a raster");
        let cells = geometry.cell_count();
        let layer = ObstacleLayer::new(geometry, vec![Occupancy::Unknown; cells]).expect("as many cells");
        let search = GridSearch::new(vec![0; cells], vec![0; cells], StepCosts::new(true));
        let inflation =
            InflationConfig { inscribed_radius_m: 0.215, inflation_radius_m: 0.55, decay_per_m: 6.0 };
        Self {
            geometry,
            layer,
            // No map: what nobody has seen counts as floor, as in the benchmark's own baselines.
            fixed: vec![Occupancy::Free; cells],
            inflation: Inflation::new(&inflation, CELL_M).expect("small enough"),
            costs: vec![0; cells],
            squared_cells: vec![0; cells],
            envelope: vec![Parabola::default(); geometry.columns()],
            planner: GridPlanner::new(search, SearchMethod::Dijkstra),
            path: vec![Waypoint::default(); 4_000],
            local: local(which, cells, seed),
            recovery: Recovery::default(),
            revision: 0,
        }
    }

    /// The request after a scan.
    pub(super) fn command(&mut self, pose: Pose2, twist: Twist2, beams: &[Beam]) -> Twist2 {
        let sensor = Point2::new(pose.x_m, pose.y_m);
        self.layer.observe(sensor, ObstacleLimits { mark_m: 10.0, clear_m: 10.0 }, beams.iter().copied());
        let layers = CostmapLayers {
            geometry: &self.geometry,
            inflation: &self.inflation,
            fixed: &self.fixed,
            observed: self.layer.cells().values(),
            zones: &[],
            people: &self.recovery.stuck,
            people_cost: PeopleCost {
                collision_radius_m: 0.0,
                deviation_m: 0.15,
                ahead_m_per_mps: 0.0,
                peak: 200,
            },
        };
        let mut scratch =
            InflationScratch { squared_cells: &mut self.squared_cells, envelope: &mut self.envelope };
        compose(&layers, &mut self.costs, &mut scratch).expect("the layers fit");
        self.revision += 1;
        self.recovery.note(pose);
        if let Some(twist) = self.recovery.backing(pose) {
            return twist;
        }
        let costmap = CostmapView::new(self.geometry, &self.costs, self.revision).expect("as many costs");
        let goal = World::goal();
        let request = PlanRequest {
            costmap,
            start_in_map: pose,
            goal_in_map: Pose2::new(goal.x_m, goal.y_m, std::f32::consts::FRAC_PI_2),
            tolerance_m: 0.5,
        };
        let Ok(plan) = self.planner.plan(&request, &mut self.path) else {
            return self.recovery.blocked(pose);
        };
        let waypoints = smooth(costmap, &mut self.path[..plan.waypoints]);
        let command = self.local.command(&LocalSituation {
            pose_in_map: pose,
            twist,
            costmap,
            path: &self.path[..waypoints],
            people: &[],
            guard: &AlwaysPermitted,
            speed_limit_mps: f32::INFINITY,
        });
        self.outcome(command, pose)
    }

    fn outcome(&mut self, command: LocalCommand, pose: Pose2) -> Twist2 {
        if command.verdict == LocalVerdict::Blocked {
            return self.recovery.blocked(pose);
        }
        self.recovery.free();
        command.twist
    }
}

fn local(which: Which, cells: usize, seed: u64) -> Box<dyn LocalPlanner> {
    match which {
        Which::Dwa => {
            let config = DwaConfig { speed_max_mps: 0.5, goal_within_m: 0.5, ..DwaConfig::PUBLISHED };
            let scratch = DwaScratch {
                path: vec![StepCell::default(); cells].leak(),
                goal: vec![StepCell::default(); cells].leak(),
            };
            Box::new(Dwa::new(config, &jackal(), scratch))
        }
        Which::Mppi => Box::new(Mppi::new(mppi(), jackal(), vec![MppiSample::default(); SAMPLES], seed)),
    }
}

/// Ours for this robot.
#[must_use]
pub fn mppi() -> MppiConfig {
    MppiConfig {
        drive: DRIVE,
        step_s: 0.06,
        period_s: PERIOD_S,
        speed_noise_mps: 0.5,
        turn_noise_radps: 1.0,
        temperature_s: 0.08,
        clear_cost: 20,
        people_acceleration_mps2: 0.4,
        person_radius_m: 0.25,
        arrival: Arrival { within_m: 0.5, within_rad: 4.0, turn_min_radps: 0.1, turn_max_radps: 1.0 },
        weights: MppiWeights::DEFAULT,
    }
}
