//! Where to go on a map that is made while the robot drives: to view points of frontiers, until nothing is left.

use floorguard_mapping::GridGeometry;
use floorguard_navigation::SearchCell;
use floorguard_navigation::costmap::{CostmapView, Costs};
use floorguard_navigation::explore::{
    FrontierScratch, TourExploration, TourExploreConfig, TourExplorer, ViewConfig, ViewPoint, ViewSearch,
    find_frontiers,
};
use floorguard_navigation::global::PlanFailure;
use floorguard_navigation::recovery::Recovery;
use floorguard_types::geometry::{Point2, Pose2};

use super::course::Course;
use super::drive::Navigator;
use super::guard_model::place_of;
use super::model::times_of;
use super::progress::{ExplorationProgress, NavigationPhase};
use super::reasons::is_standing;

/// A goal is chosen anew this often, seconds.
const DECIDE_S: f32 = 2.0;
/// Smaller frontiers are gaps between beams and shadows of legs, metres.
const SIZE_MIN_M: f32 = 0.5;
/// A frontier is looked at from within, metres.
const SIGHT_M: f32 = 6.0;
/// Ways between view points are searched on cells of this edge, metres.
const RASTER_M: f32 = 0.2;
/// Arrived for so long with the frontier still there, the robot gives it up, seconds.
const OBSERVATION_S: f32 = 1.5;
/// A goal that moved by less is the same, metres.
const SAME_M: f32 = 0.5;
/// What was given up is tried once more so often, at the end.
const SECOND_TRIES: u32 = 1;

/// What chooses the goals.
pub(super) struct Exploring {
    explorer: TourExplorer,
    search: ViewSearch<Vec<SearchCell>, Vec<u8>>,
    states: Vec<u8>,
    queue: Vec<u32>,
    next_s: f32,
    last_s: f32,
    arrived_s: Option<f32>,
    tries: u32,
    failure: Option<PlanFailure>,
    /// How far it is.
    pub(super) progress: ExplorationProgress,
}

impl Exploring {
    /// On a costmap of this raster.
    ///
    /// # Errors
    /// It makes no raster for the ways.
    pub(super) fn new(costmap: &GridGeometry) -> anyhow::Result<Self> {
        let config = ViewConfig { sight_m: SIGHT_M, stand_cost: Costs::INSCRIBED, raster_m: RASTER_M };
        let raster = ViewSearch::<Vec<SearchCell>, Vec<u8>>::raster(costmap, RASTER_M);
        let cells = raster.map_or(0, |raster| raster.cell_count());
        let storage = (vec![SearchCell::EMPTY; cells], vec![0; cells]);
        let search = ViewSearch::new(costmap, config, storage);
        Ok(Self {
            explorer: TourExplorer::new(TourExploreConfig::DEFAULT),
            search: search.ok_or_else(|| anyhow::anyhow!("the map makes no raster for ways"))?,
            states: vec![0; costmap.cell_count()],
            queue: vec![0; costmap.cell_count()],
            next_s: 0.0,
            last_s: 0.0,
            arrived_s: None,
            tries: 0,
            failure: None,
            progress: ExplorationProgress::default(),
        })
    }

    /// The planner found no path to the goal.
    pub(super) const fn note_failure(&mut self, failure: PlanFailure) {
        self.failure = Some(failure);
    }

    /// The robot stands where a frontier is in sight.
    pub(super) const fn is_observing(&self) -> bool {
        self.arrived_s.is_some()
    }

    /// In one sentence, at the end.
    pub(super) fn words(&self) -> String {
        let ExplorationProgress { known_m2, left_out, goals, .. } = self.progress;
        let rest = match left_out {
            0 => String::new(),
            count => format!(", {count} frontiers left that no way was found to"),
        };
        format!(
            "nothing that can be reached is unknown: {known_m2:.0} m² of floor known after {goals} goals{rest}"
        )
    }

    /// What to do now.
    fn decide(&mut self, costmap: CostmapView<'_>, robot: Point2, now_s: f32) -> TourExploration {
        let cell_m = costmap.geometry().resolution_m();
        let cells_min = (SIZE_MIN_M / cell_m).ceil() as u32;
        let mut scratch = FrontierScratch { states: &mut self.states, queue: &mut self.queue };
        let found = find_frontiers(costmap, robot, cells_min, &mut scratch);
        let floor = costmap.costs().iter().filter(|&&cost| cost < Costs::LETHAL).count();
        let mut points = self.search.view_points(costmap, robot, &found.frontiers);
        let before = points.points.len();
        let passed_s = now_s - std::mem::replace(&mut self.last_s, now_s);
        self.explorer.leave_out_given_up(&mut points, passed_s);
        let left_out = before - points.points.len() + points.without_way as usize;
        self.progress = ExplorationProgress {
            known_m2: floor as f32 * cell_m * cell_m,
            frontiers: points.points.len(),
            left_out,
            ..self.progress
        };
        let ways = self.search.ways(&points.points);
        self.explorer.choose(&points.points, &ways, left_out)
    }
}

impl Navigator {
    /// Chooses the goal, where the robot explores.
    pub(super) fn choose_goal(&mut self, pose: Pose2, now_s: f32) {
        let is_there = self.is_at_goal(pose) && is_standing(self.senses.motion().twist);
        let Some(exploring) = &mut self.exploring else { return };
        exploring.arrived_s = if is_there { exploring.arrived_s.or(Some(now_s)) } else { None };
        let has_failed = exploring.failure.take().is_some_and(|failure| failure != PlanFailure::StartBlocked);
        let has_looked = exploring.arrived_s.is_some_and(|since_s| now_s - since_s > OBSERVATION_S);
        if has_failed || (has_looked && exploring.progress.goals > 0) {
            exploring.explorer.goal_is_unreachable();
            exploring.next_s = now_s;
        }
        if now_s < exploring.next_s {
            return;
        }
        exploring.next_s = now_s + DECIDE_S;
        self.maps.refresh();
        let Some(costmap) = self.maps.global() else { return };
        match exploring.decide(costmap, place_of(pose), now_s) {
            TourExploration::Go(point) => self.go_and_look(&point, now_s),
            TourExploration::GivenUp(_) if exploring.tries < SECOND_TRIES => {
                exploring.tries += 1;
                exploring.explorer.try_again();
            }
            // Before the first scan nothing is known, and nothing is finished.
            _ if exploring.progress.goals == 0 && now_s < 10.0 => {}
            TourExploration::GivenUp(_) | TourExploration::Finished => self.phase = NavigationPhase::Explored,
        }
    }

    /// What was seen may be there no longer. On a known map it is forgotten around the robot; a map that is made is drawn again
    /// from the scans that were kept, in which there are no people.
    pub(super) fn forget_around(&mut self, place_in_map: Point2) {
        match self.senses.redrawn() {
            Some(scans) => self.maps.redraw(&scans),
            None => self.maps.forget_around(place_in_map),
        }
    }

    /// The goal is a view point, headed for what is looked at.
    fn go_and_look(&mut self, point: &ViewPoint, now_s: f32) {
        let (at, seen) = (point.place_in_map, point.frontier.centroid_in_map);
        let old = self.plan.goal_pose();
        if place_of(old).distance(at) < SAME_M && self.course.gear().is_some() {
            return;
        }
        let heading_rad = libm::atan2f(seen.y_m - at.y_m, seen.x_m - at.x_m);
        self.plan.goal = [at.x_m, at.y_m, heading_rad];
        self.next_plan_s = now_s;
        self.course = Course::default();
        // What obstructed the way to another goal is no reason to call for help on this one.
        self.recovery = Recovery::new(times_of(&self.plan.settings));
        if let Some(exploring) = &mut self.exploring {
            exploring.progress.goals += 1;
            exploring.arrived_s = None;
        }
    }
}
