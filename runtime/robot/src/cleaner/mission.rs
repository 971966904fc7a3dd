//! The mission itself: where the robot is, what is still dirty, which path leads there, and what to do when a person
//! stands on it.

use std::sync::Arc;

use floorguard_cleaning::{CleanRule, Planner, PoseDeviation, VisitPlan};
use floorguard_guard::{Cause, Decision};
use floorguard_host::executor::PriorityLock;
use floorguard_mapping::{DirtCell, DirtMap, Grid, GridGeometry};
use floorguard_navigation::global::Pace;
use floorguard_navigation::path::FollowState;
use floorguard_navigation::{PathSearch, SearchCell};
use floorguard_runtime::configuration::RobotConfiguration;
use floorguard_runtime::mission::RouteFollower;
use floorguard_runtime::shared::StampedPose;
use floorguard_runtime::tasks::{Mission, MissionMoment};
use floorguard_types::geometry::{Point2, Pose2, Twist2};
use floorguard_types::random::Pcg32;
use floorguard_types::sensing::DirtReading;
use floorguard_types::time::Stamp;

use super::areas::AreaKind;
use super::body::Body;
use super::ground::Ground;
use super::lane_list::LaneList;
use super::lane_plan::lanes_over;
use super::obstacles::Obstacles;
use super::pace::{among_people, pace_of};
use super::path_finder::PathFinder;
use super::plan::{MissionPlan, MissionStrategy};
use super::progress::{MissionPhase, MissionWatch};
use super::refused::RefusedMotion;
use super::retreat::PeopleNear;
use super::store::{Saved, Store};
use super::targets::{Departures, VISITS_MAX};
use super::times::{TimeUse, Times, is_standing};
use super::track::Track;
use crate::site::{Localiser, RecentPoses, scrubber};

/// Nodes of a tour: 1,024 cells, the robot, and the end of the path.
const NODES: usize = 1_026;
/// Speed in an area where the robot goes slowly, m/s.
const SLOW_MPS: f32 = 0.2;
/// Progress is made known this often, seconds.
const PROGRESS_S: f32 = 1.0;
/// What was cleaned is saved this often, seconds: a power cut loses no more.
const SAVE_S: f32 = 0.5;
/// Doubt of the saved pose, metres and radians: the robot drove on since, and came to a stand without a computer.
const ROLLED_ON: PoseDeviation = PoseDeviation { position_m: 0.6, heading_rad: 0.15 };
/// For so long it stands to find itself; after that it drives on, which shows it more, seconds.
const FINDS_S: f32 = 6.0;
/// Held for this long on its way back, the robot goes back straight: only so the guard lets it leave, seconds.
const STRAIGHT_S: f32 = 0.3;
/// An object on the floor this near may be what holds the robot, metres from its rear axle.
const OBSTACLE_HOLDS_M: f32 = 1.6;

/// A progress, for all who watch it.
pub type SharedWatch = Arc<MissionWatch<PriorityLock>>;

/// Where the scanner sits on the robot.
#[derive(Clone, Copy, Debug)]
pub(super) struct ScannerMount {
    pub(super) in_base: Pose2,
}

impl ScannerMount {
    fn of(robot: &RobotConfiguration) -> Self {
        let mounting = robot.scanner.mounting;
        Self { in_base: Pose2::new(mounting.position.x_m, mounting.position.y_m, mounting.yaw_rad) }
    }
}

/// Where the robot can go and turn, and the costs of paths. It answers for nothing from where it cannot tell where it
/// is.
fn path_finder_of(
    ground: &mut Ground,
    (plan, robot): (&MissionPlan, &RobotConfiguration),
) -> anyhow::Result<PathFinder> {
    let mut path_finder = PathFinder::new(*ground.raster(), among_people(robot, pace_of(robot)));
    ground.explore(&mut path_finder);
    if plan.strategy != MissionStrategy::Route {
        ground.floor.keep_in_sight()?;
    }
    ground.keep_to_areas(plan);
    Ok(path_finder)
}

fn search_of(raster: GridGeometry) -> PathSearch<Vec<SearchCell>> {
    PathSearch::new(raster, vec![SearchCell::EMPTY; raster.cell_count()])
}

/// Sure of its place; after a break anywhere within what it may have rolled on.
fn localiser_of(
    (ground, plan): (&Ground, &MissionPlan),
    cells: DirtMap<Vec<DirtCell>>,
    was_broken_off: bool,
) -> Localiser {
    let config = scrubber::belief(plan.tolerated_units);
    let mut localiser = Localiser::new(&ground.floor, config, cells, Pcg32::new(plan.seed, 71));
    if was_broken_off {
        localiser.restart_within(Pose2::default(), ROLLED_ON);
    }
    localiser
}

/// The lanes of a mission that drives over everything; none for one that knows where it wants to go.
fn lanes_of(plan: &MissionPlan, ground: &Ground) -> LaneList {
    match plan.strategy {
        MissionStrategy::Systematic => LaneList::new(lanes_over(ground)),
        _ => LaneList::default(),
    }
}

/// The mission of a driving robot.
pub struct Cleaner {
    pub(super) plan: MissionPlan,
    pub(super) ground: Ground,
    pub(super) localiser: Localiser,
    pub(super) rule: CleanRule,
    pub(super) tours: VisitPlan<Vec<SearchCell>, Vec<u16>, Vec<u8>, NODES>,
    pub(super) obstructed: Vec<bool>,
    pub(super) track: Track,
    pub(super) odometry: StampedPose,
    pub(super) phase: MissionPhase,
    pub(super) times: Times,
    pub(super) detours: u32,
    pub(super) distance_m: f32,
    pub(super) watch: SharedWatch,
    pub(super) store: Store,
    /// The plan that its saves belong to, where that is not the one that it drives by.
    pub(super) saved_as: Option<MissionPlan>,
    pub(super) path_finder: PathFinder,
    pub(super) guess: PathSearch<Vec<SearchCell>>,
    pub(super) obstacles: Obstacles,
    /// Everybody and everything that is tracked, odometry frame.
    pub(super) people_seen: Vec<Point2>,
    pub(super) near: PeopleNear,
    pub(super) pace: Pace,
    pub(super) scanner_mount: ScannerMount,
    pub(super) route: RouteFollower,
    pub(super) lanes: LaneList,
    pub(super) poses: RecentPoses,
    pub(super) dirt: Option<DirtReading>,
    pub(super) began: Option<Stamp>,
    /// Cells that are to be cleaned, as of the last plan.
    pub(super) wanted: Vec<bool>,
    /// How many passes each cell has had at its place, or beside it.
    pub(super) passes: Vec<u8>,
    pub(super) target: Option<usize>,
    pub(super) postponed: Vec<(usize, f32)>,
    pub(super) departures: Departures,
    pub(super) try_s: f32,
    pub(super) requested: Twist2,
    pub(super) held_s: f32,
    pub(super) held_at: Option<(Point2, f32)>,
    pub(super) held_by: Option<Cause>,
    pub(super) refused: RefusedMotion,
    pub(super) last_s: f32,
    pub(super) next_report_s: f32,
    pub(super) save_s: f32,
    /// Nothing is left to be saved.
    pub(super) is_kept: bool,
    pub(super) next_retry_s: f32,
    pub(super) lost_s: f32,
}

impl Cleaner {
    /// Ready to begin, or to go on where `store` says that a mission was broken off.
    ///
    /// # Errors
    /// The plan has no floor for this robot, or nowhere a wall by which it could tell where it is.
    pub fn new(
        plan: &MissionPlan,
        robot: &RobotConfiguration,
        (watch, store): (SharedWatch, Store),
    ) -> anyhow::Result<Self> {
        let mut ground = Ground::new(plan, (Body::of(robot), scrubber::BRUSH))?;
        let raster = *ground.raster();
        let path_finder = path_finder_of(&mut ground, (plan, robot))?;
        let mut cells = plan.prior(&ground.expected);
        let saved = store.load(plan, cells.len());
        if let Some(saved) = &saved {
            saved.restore(&raster, &mut cells);
            ground.floor.start = saved.pose_in_map;
        }
        let lanes = lanes_of(plan, &ground);
        let stream = |number| Pcg32::new(plan.seed, number);
        let planner = Planner::new(search_of(raster), vec![0; NODES * NODES], stream(72));
        let localiser = localiser_of((&ground, plan), Grid::new(raster, cells)?, saved.is_some());
        Ok(Self {
            rule: CleanRule::per_cell(plan.tolerated_units, plan.delta),
            tours: VisitPlan::new(planner, vec![0; raster.cell_count()], VISITS_MAX),
            obstructed: vec![false; raster.cell_count()],
            track: Track::default(),
            odometry: StampedPose::default(),
            phase: MissionPhase::Starting,
            times: Times::default(),
            detours: 0,
            distance_m: 0.0,
            watch,
            store,
            saved_as: None,
            path_finder,
            guess: search_of(raster),
            obstacles: Obstacles::new(raster),
            people_seen: Vec::new(),
            near: PeopleNear::of(robot),
            pace: pace_of(robot),
            scanner_mount: ScannerMount::of(robot),
            route: RouteFollower::new(robot.route.clone(), robot.route_limits),
            lanes,
            poses: RecentPoses::default(),
            dirt: None,
            began: None,
            wanted: vec![false; raster.cell_count()],
            passes: vec![0; raster.cell_count()],
            target: None,
            postponed: Vec::new(),
            departures: Departures::default(),
            try_s: 0.0,
            requested: Twist2::ZERO,
            held_s: 0.0,
            held_at: None,
            held_by: None,
            refused: RefusedMotion::default(),
            last_s: 0.0,
            next_report_s: 0.0,
            save_s: 0.0,
            is_kept: false,
            next_retry_s: 0.0,
            lost_s: 0.0,
            plan: plan.clone(),
            ground,
            localiser,
        })
    }

    /// Where the robot is believed to be, map frame.
    pub(super) fn pose(&self) -> Pose2 {
        self.localiser.pose(self.odometry.pose_in_odometry)
    }

    /// What the time since the last moment went to.
    fn time_use(&self, moment: &MissionMoment<'_>) -> TimeUse {
        if self.phase.is_over() {
            TimeUse::Done
        } else if moment.is_paused {
            TimeUse::Paused
        } else if self.requested != Twist2::ZERO {
            TimeUse::of(self.requested, moment.decision)
        } else if self.lost_s > 0.0 {
            TimeUse::Finding
        } else {
            TimeUse::NoPath
        }
    }

    /// The guard does not permit the requested velocity.
    fn notice_hold(&mut self, decision: Option<Decision>, lasted_s: f32) {
        let wants_motion = self.requested != Twist2::ZERO;
        let stands = decision.is_none_or(|decision| is_standing(decision.permitted));
        if !(wants_motion && stands) {
            self.held_s = 0.0;
            return;
        }
        let cause = decision.and_then(|decision| decision.holding_cause).map(|record| record.cause);
        let on_path = [Cause::ScanProtective, Cause::LidarProtective, Cause::WayClosed, Cause::CollisionStop];
        let pose = self.pose();
        let obstacle_lies = || self.obstacles.lies_near(Point2::new(pose.x_m, pose.y_m), OBSTACLE_HOLDS_M);
        if cause.is_none_or(|cause| on_path.contains(&cause)) || obstacle_lies() {
            self.held_s += lasted_s;
            self.held_by = cause;
        }
    }

    /// The robot's requested velocity.
    fn decide(&mut self, now_s: f32) -> Twist2 {
        if self.plan.strategy == MissionStrategy::Route {
            return self.route.wanted(self.odometry.pose_in_odometry);
        }
        if self.lost_s > 0.0 && self.lost_s < FINDS_S {
            return Twist2::ZERO;
        }
        let pose = self.pose();
        if self.plan.strategy == MissionStrategy::Guarantee && self.tours.is_due(now_s) {
            self.replan(pose, now_s);
        }
        self.retreat(pose, now_s);
        if self.held_s > self.patience_s(now_s) {
            self.held_s = 0.0;
            self.go_round(pose, now_s);
        }
        // A path that ends at once is followed by the next; four are more than ever follow each other.
        for _ in 0..4 {
            if self.track.is_over() && !self.choose(pose, now_s) {
                return Twist2::ZERO;
            }
            match self.track.follow(pose, &self.pace) {
                FollowState::Drive(twist) => return self.permitted_way(twist),
                FollowState::Arrived => self.arrive(),
                FollowState::Lost => self.track = Track::default(),
            }
        }
        Twist2::ZERO
    }

    /// From what is in its fields the guard lets a robot leave straight only.
    fn permitted_way(&self, twist: Twist2) -> Twist2 {
        if twist.linear_mps < 0.0 && self.held_s > STRAIGHT_S {
            Twist2 { angular_radps: 0.0, ..twist }
        } else {
            twist
        }
    }

    /// In an area where the robot goes slowly the same curve, slowly.
    pub(super) fn slowed(&self, requested: Twist2) -> Twist2 {
        let speed_mps = requested.linear_mps.abs();
        if speed_mps <= SLOW_MPS || !self.plan.has(AreaKind::Slow) {
            return requested;
        }
        let places = self.ground.body.ahead.places(self.pose());
        if !places.iter().any(|place| self.plan.lies_in(AreaKind::Slow, *place)) {
            return requested;
        }
        let share = SLOW_MPS / speed_mps;
        Twist2 { linear_mps: share * requested.linear_mps, angular_radps: share * requested.angular_radps }
    }

    /// What a power cut must not take.
    fn save(&mut self, now_s: f32) {
        if now_s < self.save_s || self.is_kept {
            return;
        }
        if self.phase.is_over() {
            self.is_kept = true;
            return self.store.finish();
        }
        self.save_s = now_s + SAVE_S;
        let prior = self.plan.prior(&self.ground.expected);
        let saved = Saved::of(self.pose(), self.localiser.map.values(), &prior);
        self.store.save(self.saved_as.as_ref().unwrap_or(&self.plan), &saved);
    }
}

impl Cleaner {
    /// Takes in what the senses bring, also while the drive drives. Gives the seconds since it began, and since the last moment.
    pub(super) fn observe(&mut self, moment: &MissionMoment<'_>) -> (f32, f32) {
        let began = *self.began.get_or_insert(moment.now);
        let now_s = moment.now.as_micros().saturating_sub(began.as_micros()) as f32 * 1.0e-6;
        let lasted_s = now_s - std::mem::replace(&mut self.last_s, now_s);
        self.remember(moment.pose);
        self.hear(moment.dirt, moment.now);
        if let Some(scan) = moment.scan {
            self.see(scan, now_s);
        }
        if let Some(people) = moment.people {
            self.see_people(people, (moment.now, now_s));
        }
        if let Some(floor) = moment.floor {
            self.see_floor(floor, now_s);
        }
        (now_s, lasted_s)
    }
}

impl Mission for Cleaner {
    fn step(&mut self, moment: &MissionMoment<'_>) -> Twist2 {
        let (now_s, lasted_s) = self.observe(moment);
        let permitted = moment.decision.map_or(Twist2::ZERO, |decision| decision.permitted);
        self.times.add(self.time_use(moment), (self.requested, permitted), lasted_s);
        if self.phase.is_over() {
            self.requested = Twist2::ZERO;
        } else if moment.is_paused {
            self.phase = MissionPhase::Paused;
            self.requested = Twist2::ZERO;
        } else {
            self.notice_hold(moment.decision, lasted_s);
            self.lost_s = if self.localiser.is_trusted() { 0.0 } else { self.lost_s + lasted_s };
            self.phase = if self.held_s > 0.5 { MissionPhase::Waiting } else { MissionPhase::Cleaning };
            self.requested = self.decide(now_s);
            self.requested = self.slowed(self.requested);
        }
        self.save(now_s);
        if now_s >= self.next_report_s {
            self.next_report_s = now_s + PROGRESS_S;
            self.watch.publish(Arc::new(self.progress(moment.now)));
        }
        self.requested
    }
}

#[cfg(test)]
#[path = "mission_tests.rs"]
mod tests;
