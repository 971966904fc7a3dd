//! The mission itself: where the robot is, what is still dirty, which way leads there, and what to do when somebody stands
//! in it.

use std::collections::VecDeque;
use std::sync::Arc;

use embassy_sync::blocking_mutex::raw::CriticalSectionRawMutex;
use floorguard_core::cleaning::{CleanRule, PathSearch, Planner, SearchCell};
use floorguard_core::geometry::{Point2, Pose2, Twist2, wrap_angle};
use floorguard_core::guard::{Cause, Decision};
use floorguard_core::maps::{Grid, GridGeometry, NO_SLOT};
use floorguard_core::people::TrackStatus;
use floorguard_core::random::Pcg32;
use floorguard_core::sensing::{DirtReading, Scan};
use floorguard_core::time::{Age, Stamp};
use floorguard_runtime::configuration::RobotConfiguration;
use floorguard_runtime::mission::RouteFollower;
use floorguard_runtime::shared::{PeopleReport, StampedPose};
use floorguard_runtime::tasks::{
    CleaningMission, FloorSight, MissionMoment, PERSON_PROBABILITY_MIN, THING_HEIGHT_MIN_M,
};

use super::body::Body;
use super::ground::Ground;
use super::lattice::{Gear, Lattice, Pace, STEP_M, Waypoint};
use super::obstacles::{Obstacles, ends_of};
use super::plan::{MissionPlan, MissionStrategy};
use super::progress::{MissionPhase, MissionWatch};
use super::store::{Saved, Store};
use super::track::{Track, Tracking};
use super::visits::CLUSTER_M;
use crate::mission::{Lane, Localiser, lanes, scrubber};

/// Nodes of a tour: 1,024 cells, the robot, and the end of the path.
const NODES: usize = 1_026;
/// The way is planned again this often, seconds (AMB-12).
const REPLAN_S: f32 = 5.0;
/// Held by the guard for this long, the robot looks for a way round, seconds.
const PATIENCE_S: f32 = 3.0;
/// A cell that nobody can get to now is tried again after this, seconds.
const POSTPONED_S: f32 = 12.0;
/// After so many visits a cell is given up, and reported.
pub(super) const VISITS_MAX: u8 = 12;
/// After tries in vain the robot waits this long before the next, seconds.
const TRY_AGAIN_S: f32 = 1.0;
/// Progress is made known this often, seconds.
const PROGRESS_S: f32 = 1.0;
/// What was cleaned is saved this often, seconds: a power cut loses no more.
const SAVE_S: f32 = 1.0;
/// Doubt of the saved pose, metres and radians: the robot rolled on after it, and came to a stand without a computer.
const ROLLED_ON: (f32, f32) = (0.35, 0.15);
/// While the pose is not trusted a scan is taken in this often even if the robot stands, seconds.
const LOOKS_S: f32 = 0.2;
/// For so long it stands to find itself; after that it drives on, which shows it more, seconds.
const FINDS_S: f32 = 6.0;
/// Without a word of the dirt sensor for this long nothing counts as cleaned, microseconds.
const DEAF_US: u64 = 500_000;
/// One beam in this many is matched with the map.
const BEAM_INTERVAL: usize = 9;
/// Beams that end this near to somebody are no part of the map, metres: a body, its luggage or its trolley.
const SOMEBODY_M: f32 = 0.8;
/// A place this far from all that is on the map is the middle of a free floor, metres.
const MIDDLE_M: f32 = 0.6;
/// Poses of the last second, to find the one of a scan.
const POSES: usize = 24;
/// Slower than this is standing, m/s and rad/s.
const STANDS: (f32, f32) = (0.02, 0.02);
/// From the last cell the robot drives off by this, so that the brush has left it, metres.
const LEAVES_M: f32 = 0.9;
/// Times that it does so at the end.
const LEAVINGS_MAX: u8 = 6;
/// Held again within this distance, the robot does something else first, metres.
const SAME_PLACE_M: f32 = 0.3;
/// Waypoints that are left on the last straight, over the dirt.
const PASS_LEGS: usize = 1;
/// Held for this long at a place, the robot goes elsewhere first, seconds.
const STAYS_S: f32 = 8.0;
/// What is higher than this the scanner sees, metres.
const LOW_M: f32 = 0.14;
/// A thing on the floor this near may be what holds the robot, metres from its rear axle.
const THING_HOLDS_M: f32 = 1.6;
/// Cells of the tour that are tried before the robot waits.
const TRIES: usize = 4;

/// A progress that anybody may watch.
pub type SharedWatch = Arc<MissionWatch<CriticalSectionRawMutex>>;

/// Where the scanner sits on the robot.
#[derive(Clone, Copy, Debug)]
struct Eye {
    in_base: Pose2,
}

/// What a way costs among people: the guard lets the robot go more slowly there, and its front wheel no faster than in the
/// slowest fields while it turns on the spot.
fn among_people(robot: &RobotConfiguration, pace: Pace) -> Pace {
    let slow_mps = robot.thresholds.warning_speed_mps;
    Pace {
        speed_mps: pace.speed_mps.min(2.0 * slow_mps),
        turn_radps: pace.turn_radps.min(slow_mps / robot.geometry.wheelbase_m),
        ..pace
    }
}

impl Eye {
    fn of(robot: &RobotConfiguration) -> Self {
        let mounting = robot.scanner.mounting;
        Self { in_base: Pose2::new(mounting.position.x_m, mounting.position.y_m, mounting.yaw_rad) }
    }
}

/// How fast the mission drives: carefully, whatever the robot may do.
fn pace_of(robot: &RobotConfiguration) -> Pace {
    Pace {
        speed_mps: robot.route_limits.speed_mps.min(0.7),
        turn_radps: robot.route_limits.turn_radps,
        reverse_mps: robot.limits.reverse_mps.min(0.2),
        change_s: 1.2,
    }
}

/// Where the robot can go and turn, and what the ways cost.
fn lattice_of(ground: &mut Ground, robot: &RobotConfiguration) -> Lattice {
    let mut lattice = Lattice::new(*ground.raster(), among_people(robot, pace_of(robot)));
    ground.explore(&mut lattice);
    lattice
}

fn search_of(raster: GridGeometry) -> PathSearch<Vec<SearchCell>> {
    PathSearch::new(raster, vec![SearchCell::EMPTY; raster.cell_count()])
}

/// The lanes of a mission that drives over everything; none for one that knows where it wants to go.
fn lanes_of(plan: &MissionPlan, ground: &Ground) -> VecDeque<Lane> {
    let start = Point2::new(ground.floor.start.x_m, ground.floor.start.y_m);
    match plan.strategy {
        MissionStrategy::Systematic => lanes(&ground.floor, scrubber::BRUSH.width_m, start).into(),
        _ => VecDeque::new(),
    }
}

/// The mission of a driving robot.
pub struct Cleaner {
    pub(super) plan: MissionPlan,
    pub(super) ground: Ground,
    pub(super) localiser: Localiser,
    pub(super) rule: CleanRule,
    pub(super) planner: Planner<Vec<SearchCell>, Vec<u16>, NODES>,
    pub(super) visits: Vec<u8>,
    pub(super) obstructed: Vec<bool>,
    pub(super) track: Track,
    pub(super) odometry: StampedPose,
    pub(super) phase: MissionPhase,
    pub(super) waited_s: f32,
    pub(super) detours: u32,
    pub(super) distance_m: f32,
    watch: SharedWatch,
    store: Store,
    pub(super) lattice: Lattice,
    pub(super) guess: PathSearch<Vec<SearchCell>>,
    pub(super) obstacles: Obstacles,
    /// Everybody and everything that is tracked, odometry frame.
    somebody: Vec<Point2>,
    pace: Pace,
    eye: Eye,
    route: RouteFollower,
    lanes: VecDeque<Lane>,
    poses: VecDeque<StampedPose>,
    dirt: Option<DirtReading>,
    began: Option<Stamp>,
    /// Cells that are to be cleaned, as of the last plan.
    pub(super) wanted: Vec<bool>,
    /// Cells at a place where the brush was already.
    passed: Vec<bool>,
    pub(super) target: Option<usize>,
    postponed: Vec<(usize, f32)>,
    leavings: u8,
    try_s: f32,
    is_waiting: bool,
    wish: Twist2,
    held_s: f32,
    held_at: Option<(Point2, f32)>,
    last_s: f32,
    plan_s: f32,
    tell_s: f32,
    save_s: f32,
    /// Nothing is left to be saved.
    is_kept: bool,
    look_s: f32,
    lost_s: f32,
}

impl Cleaner {
    /// Ready to begin, or to go on where `store` says that a mission was broken off.
    ///
    /// # Errors
    /// The plan has no floor for this robot.
    pub fn new(
        plan: &MissionPlan,
        robot: &RobotConfiguration,
        (watch, store): (SharedWatch, Store),
    ) -> anyhow::Result<Self> {
        let mut ground = Ground::new(plan, (Body::of(robot), scrubber::BRUSH))?;
        let raster = *ground.raster();
        let lattice = lattice_of(&mut ground, robot);
        let mut cells = plan.prior(&ground.expected);
        let saved = store.load(plan, cells.len());
        if let Some(saved) = &saved {
            saved.restore(&mut cells);
            ground.floor.start = saved.pose_in_map;
        }
        let stream = |number| Pcg32::new(plan.seed, number);
        let config = scrubber::belief(plan.tolerated_units);
        let mut localiser = Localiser::new(&ground.floor, config, Grid::new(raster, cells)?, stream(71));
        if saved.is_some() {
            localiser.restart_within(Pose2::default(), ROLLED_ON);
        }
        Ok(Self {
            rule: CleanRule::per_cell(plan.tolerated_units, plan.delta),
            planner: Planner::new(search_of(raster), vec![0; NODES * NODES], stream(72)),
            visits: vec![0; raster.cell_count()],
            obstructed: vec![false; raster.cell_count()],
            track: Track::default(),
            odometry: StampedPose::default(),
            phase: MissionPhase::Starting,
            waited_s: 0.0,
            detours: 0,
            distance_m: 0.0,
            watch,
            store,
            lattice,
            guess: search_of(raster),
            obstacles: Obstacles::new(raster),
            somebody: Vec::new(),
            pace: pace_of(robot),
            eye: Eye::of(robot),
            route: RouteFollower::new(robot.route.clone(), robot.route_limits),
            lanes: lanes_of(plan, &ground),
            poses: VecDeque::new(),
            dirt: None,
            began: None,
            wanted: vec![false; raster.cell_count()],
            passed: vec![false; raster.cell_count()],
            target: None,
            postponed: Vec::new(),
            leavings: 0,
            try_s: 0.0,
            is_waiting: false,
            wish: Twist2::ZERO,
            held_s: 0.0,
            held_at: None,
            last_s: 0.0,
            plan_s: 0.0,
            tell_s: 0.0,
            save_s: 0.0,
            is_kept: false,
            look_s: 0.0,
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

    fn remember(&mut self, pose: StampedPose) {
        let before = std::mem::replace(&mut self.odometry, pose);
        let (from, to) = (before.pose_in_odometry, pose.pose_in_odometry);
        self.distance_m += (to.x_m - from.x_m).hypot(to.y_m - from.y_m);
        self.poses.push_back(pose);
        if self.poses.len() > POSES {
            self.poses.pop_front();
        }
    }

    /// What the dirt sensor has counted since it was asked last; a sensor that is silent leaves everything open.
    fn hear(&mut self, dirt: Option<DirtReading>, now: Stamp) {
        let fresh = dirt.filter(|dirt| matches!(dirt.stamp.age(now), Age::Past(us) if us <= DEAF_US));
        let hits = match (self.dirt, fresh) {
            (Some(before), Some(dirt)) => dirt.hits_since(&before),
            (None, Some(_)) => Some(0),
            (_, None) => None,
        };
        self.localiser.collect(hits.map_or(0, u32::from), hits.is_none());
        self.localiser.brush_turns = fresh.is_some_and(|dirt| dirt.brush_turns);
        self.dirt = fresh.or(self.dirt);
    }

    /// A scan, at the pose where it was measured.
    fn see(&mut self, scan: &Scan, now_s: f32) {
        let odometry = self.odometry_at(scan.stamp);
        let is_lost = !self.localiser.is_trusted();
        if self.localiser.is_due(odometry) || (is_lost && now_s >= self.look_s) {
            self.look_s = now_s + LOOKS_S;
            let interval = if is_lost { BEAM_INTERVAL / 3 } else { BEAM_INTERVAL };
            // A customer is not on the map, and says nothing of where the robot is; nor does what stands in the middle of a
            // free floor. Beams that end behind a wall do.
            let guess = self.localiser.pose(odometry);
            let is_of_somebody = |end: &Point2| {
                let place = odometry.transform(*end);
                self.somebody.iter().any(|person| person.distance(place) < SOMEBODY_M)
                    || self.ground.floor.clearance.clearance_m(guess.transform(*end)) > MIDDLE_M
            };
            let ends = ends_of(scan, interval).map(|end| self.eye.in_base.transform(end));
            let matched: Vec<Point2> = ends.filter(|end| !is_of_somebody(end)).collect();
            self.localiser.update(&self.ground.floor, odometry, &matched, true);
        }
        let pose = self.localiser.pose(odometry);
        self.obstacles.see(&self.ground.floor, pose.compose(self.eye.in_base), (scan, now_s));
    }

    /// People are in the way where they are, also behind the robot, where the scanner does not look.
    fn see_people(&mut self, people: &PeopleReport, now_s: f32) {
        let confirmed = people.people.iter().filter(|person| person.status == TrackStatus::Confirmed);
        self.somebody = confirmed.map(|person| person.position).collect();
        let to_map = self.pose().compose(self.odometry.pose_in_odometry.inverse());
        let real = people.people.iter().filter(|person| {
            person.status == TrackStatus::Confirmed && person.person_probability >= PERSON_PROBABILITY_MIN
        });
        let places: Vec<Point2> = real.map(|person| to_map.transform(person.position)).collect();
        self.obstacles.see_people(&places, now_s);
    }

    /// Low things on the floor, which neither lidar nor scanner sees, are driven round; higher ones those see.
    fn see_floor(&mut self, floor: &FloorSight, now_s: f32) {
        if !floor.is_known {
            return;
        }
        let low = floor.things.iter().filter(|thing| (THING_HEIGHT_MIN_M..LOW_M).contains(&thing.height_m));
        let things: Vec<(Point2, f32)> = low.map(|thing| (thing.position, thing.half_width_m)).collect();
        let pose = self.localiser.pose(self.odometry_at(floor.stamp));
        if self.obstacles.see_things(&self.ground.floor, pose, (&things, now_s))
            && self.plan.strategy == MissionStrategy::Guarantee
        {
            self.detours += 1;
            self.track = Track::default();
        }
    }

    /// Between the poses around a moment; the nearest one outside.
    fn odometry_at(&self, stamp: Stamp) -> Pose2 {
        let after = self.poses.iter().position(|known| known.stamp >= stamp);
        let pair =
            after.and_then(|after| Some((self.poses.get(after.checked_sub(1)?)?, self.poses.get(after)?)));
        let Some((from, to)) = pair else {
            let edge = if after.is_some() { self.poses.front() } else { self.poses.back() };
            return edge.map_or(self.odometry.pose_in_odometry, |known| known.pose_in_odometry);
        };
        let micros = |stamp: Stamp| stamp.as_micros().saturating_sub(from.stamp.as_micros()) as f32;
        let t = micros(stamp) / micros(to.stamp).max(1.0);
        let (a, b) = (from.pose_in_odometry, to.pose_in_odometry);
        let turned = wrap_angle(b.heading_rad - a.heading_rad);
        Pose2::new(
            a.x_m + t * (b.x_m - a.x_m),
            a.y_m + t * (b.y_m - a.y_m),
            wrap_angle(a.heading_rad + t * turned),
        )
    }

    /// The guard does not let the robot do what it wishes.
    fn notice_hold(&mut self, decision: Option<Decision>, lasted_s: f32) {
        if std::mem::take(&mut self.is_waiting) {
            self.waited_s += lasted_s;
        }
        let wishes = self.wish != Twist2::ZERO;
        let stands = decision.is_none_or(|decision| {
            decision.permitted.linear_mps.abs() < STANDS.0
                && decision.permitted.angular_radps.abs() < STANDS.1
        });
        if !(wishes && stands) {
            self.held_s = 0.0;
            return;
        }
        let cause = decision.and_then(|decision| decision.primary_cause).map(|record| record.cause);
        let in_the_way = [Cause::ScanProtective, Cause::LidarProtective, Cause::CollisionStop];
        let pose = self.pose();
        let thing_lies = || self.obstacles.lies_near(Point2::new(pose.x_m, pose.y_m), THING_HOLDS_M);
        if cause.is_none_or(|cause| in_the_way.contains(&cause)) || thing_lies() {
            self.held_s += lasted_s;
            self.waited_s += lasted_s;
        }
    }

    /// What the robot wishes to do now.
    fn decide(&mut self, now_s: f32) -> Twist2 {
        if self.plan.strategy == MissionStrategy::Route {
            return self.route.wanted(self.odometry.pose_in_odometry);
        }
        if self.lost_s > 0.0 && self.lost_s < FINDS_S {
            return Twist2::ZERO;
        }
        let pose = self.pose();
        if self.plan.strategy == MissionStrategy::Guarantee && now_s >= self.plan_s {
            self.replan(pose, now_s);
        }
        if self.held_s > PATIENCE_S {
            self.held_s = 0.0;
            self.go_round(pose, now_s);
        }
        // A way that ends at once is followed by the next; four are more than ever follow each other.
        for _ in 0..4 {
            if self.track.is_over() && !self.choose(pose, now_s) {
                self.is_waiting = self.phase != MissionPhase::Done;
                return Twist2::ZERO;
            }
            match self.track.follow(pose, &self.pace) {
                Tracking::Drive(twist) => return twist,
                Tracking::Arrived => self.arrive(),
                Tracking::Lost => self.track = Track::default(),
            }
        }
        Twist2::ZERO
    }

    fn arrive(&mut self) {
        self.track = Track::default();
        if let Some(target) = self.target.take() {
            self.visits[target] = self.visits[target].saturating_add(1);
            let around: Vec<usize> = self.cells_within(target, CLUSTER_M).collect();
            around.into_iter().for_each(|cell| self.passed[cell] = true);
            if self.planner.tour().next() == Some(target) {
                self.planner.drop_first();
            }
        }
    }

    /// The tour over what is dirty; a cell that became clean on the way is no target any more.
    fn replan(&mut self, pose: Pose2, now_s: f32) {
        self.plan_s = now_s + REPLAN_S;
        let here = Point2::new(pose.x_m, pose.y_m);
        let Some(cell) = self.ground.floor.nearest_passable(here) else { return };
        let grazed = self.localiser.grazed(&self.rule);
        let (map, rule, visits) = (&self.localiser.map, &self.rule, &self.visits);
        let floor = &self.ground.floor;
        for (cell, is_wanted) in self.wanted.iter_mut().enumerate() {
            let is_dirty = map.get(cell).is_some_and(|dirt| rule.needs_cleaning(dirt));
            *is_wanted = floor.reachable[cell]
                && visits[cell] < VISITS_MAX
                && (is_dirty || grazed.binary_search(&cell).is_ok());
        }
        let all_wanted = &self.wanted;
        let wanted = |cell: usize| all_wanted[cell];
        let passable = |cell: usize| floor.passable[cell] || floor.reachable[cell];
        // A tour that does not fit its memory is the one before, without what is clean by now.
        let _ = self.planner.replan(cell, (wanted, passable), 500);
        // A pass that has begun is not broken off while any of its dirt is left.
        let is_gone = |target: usize| {
            let is_decided = map.get(target).is_some_and(|dirt| dirt.slot == NO_SLOT);
            is_decided && !self.is_wanted_within(target, CLUSTER_M)
        };
        if self.target.is_some_and(is_gone) {
            self.target = None;
            self.track = Track::default();
        }
    }

    /// Somebody or something stands in the way: another way if there is one. Who walks is gone in a moment; only what stays
    /// sends the robot to another cell first.
    fn go_round(&mut self, pose: Pose2, now_s: f32) {
        self.detours += 1;
        let here = Point2::new(pose.x_m, pose.y_m);
        let again = self.held_at.filter(|(before, _)| before.distance(here) < SAME_PLACE_M);
        let (_, since_s) = *self.held_at.insert(again.unwrap_or((here, now_s)));
        let Some(target) = self.target else {
            self.track = Track::default();
            return;
        };
        if now_s - since_s > STAYS_S {
            self.held_at = None;
            self.track = Track::default();
            self.postpone(target, now_s);
        } else if self.track.rest().len() > PASS_LEGS {
            // A pass that has begun is waited for: any other way would begin it again.
            self.plan_to(target, pose, now_s);
        }
    }

    /// Leaves a cell and the dirt around it for later.
    fn postpone(&mut self, cell: usize, now_s: f32) {
        self.obstructed[cell] = true;
        self.target = None;
        let around: Vec<usize> =
            self.cells_within(cell, CLUSTER_M).filter(|near| self.wanted[*near] || *near == cell).collect();
        self.postponed.retain(|(other, until_s)| !around.contains(other) && *until_s > now_s);
        self.postponed.extend(around.into_iter().map(|near| (near, now_s + POSTPONED_S)));
    }

    /// Some cell within a distance of this one is still to be cleaned.
    fn is_wanted_within(&self, cell: usize, distance_m: f32) -> bool {
        self.cells_within(cell, distance_m).any(|near| self.wanted[near])
    }

    fn cells_within(&self, cell: usize, distance_m: f32) -> impl Iterator<Item = usize> {
        let raster = *self.ground.raster();
        let centre = raster.centre(cell);
        let (column, row) = raster.coordinates_of(centre);
        let reach = (distance_m * raster.cells_per_metre()).ceil() as i32;
        let offsets = (-reach..=reach).flat_map(move |dy| (-reach..=reach).map(move |dx| (dx, dy)));
        let cells = offsets.filter_map(move |(dx, dy)| raster.index(column + dx, row + dy));
        cells.filter(move |near| raster.centre(*near).distance(centre) <= distance_m)
    }

    /// Finds something to do; false: wait, or the mission is over.
    fn choose(&mut self, pose: Pose2, now_s: f32) -> bool {
        if self.plan.strategy == MissionStrategy::Systematic {
            return self.next_lane(pose, now_s);
        }
        if now_s < self.try_s {
            return false;
        }
        // What the brush has just passed over is no target any more.
        self.replan(pose, now_s);
        self.postponed.retain(|(_, until_s)| *until_s > now_s);
        for _ in 0..TRIES {
            let is_postponed = |cell: &usize| self.postponed.iter().any(|(other, _)| other == cell);
            let open = || self.planner.tour().filter(|cell| !is_postponed(cell));
            // What a pass has left is done on a second round: at once it would cost a turn, among the same people.
            let fresh = open().find(|cell| !self.passed[*cell]);
            let Some(cell) = fresh.or_else(|| open().next()) else { break };
            if self.plan_to(cell, pose, now_s) {
                self.leavings = 0;
                return true;
            }
            self.postpone(cell, now_s);
        }
        self.try_s = now_s + TRY_AGAIN_S;
        if self.planner.tour().next().is_some() {
            return false;
        }
        self.end(pose, now_s)
    }

    /// Nothing is left: the last cells are decided only when the brush has left them.
    fn end(&mut self, pose: Pose2, now_s: f32) -> bool {
        if self.localiser.active_cells() == 0 || self.leavings >= LEAVINGS_MAX {
            self.phase = MissionPhase::Done;
            return false;
        }
        self.leavings += 1;
        let here = Point2::new(pose.x_m, pose.y_m);
        let is_far = |pose: Pose2| Point2::new(pose.x_m, pose.y_m).distance(here) > LEAVES_M;
        self.search((pose, now_s), (|_: Pose2| Some(0.0), is_far)).is_some_and(|way| {
            self.track = Track::new(way);
            self.plan_s = now_s;
            true
        })
    }

    /// The next lane that can be got to; one that nobody can get to is left out.
    fn next_lane(&mut self, pose: Pose2, now_s: f32) -> bool {
        for _ in 0..TRIES {
            let Some((from, to)) = self.lanes.pop_front() else {
                self.phase = MissionPhase::Done;
                return false;
            };
            let heading_rad = (to.y_m - from.y_m).atan2(to.x_m - from.x_m);
            let start = |pose: Pose2| {
                let is_there = Point2::new(pose.x_m, pose.y_m).distance(from) < 0.15;
                is_there && wrap_angle(pose.heading_rad - heading_rad).abs() < 0.2
            };
            let speed_mps = self.pace.speed_mps;
            let left_s = move |pose: Pose2| Some(Point2::new(pose.x_m, pose.y_m).distance(from) / speed_mps);
            let Some(mut way) = self.search((pose, now_s), (left_s, start)) else { continue };
            let steps = (from.distance(to) / STEP_M).floor() as i32;
            for step in 1..=steps {
                let share = step as f32 * STEP_M;
                let next = Pose2::new(from.x_m, from.y_m, heading_rad).compose(Pose2::new(share, 0.0, 0.0));
                if !self.ground.is_free(next, Gear::Ahead) {
                    break;
                }
                way.push(Waypoint { pose: next, gear: Gear::Ahead });
            }
            self.track = Track::new(way);
            return true;
        }
        false
    }

    /// What a power cut must not take.
    fn save(&mut self, now_s: f32) {
        if now_s < self.save_s || self.is_kept {
            return;
        }
        if self.phase == MissionPhase::Done {
            self.is_kept = true;
            return self.store.finish();
        }
        self.save_s = now_s + SAVE_S;
        let prior = self.plan.prior(&self.ground.expected);
        let saved = Saved::of(self.pose(), self.localiser.map.values(), &prior);
        self.store.save(&self.plan, &saved);
    }
}

impl CleaningMission for Cleaner {
    fn step(&mut self, moment: &MissionMoment<'_>) -> Twist2 {
        let began = *self.began.get_or_insert(moment.now);
        let now_s = moment.now.as_micros().saturating_sub(began.as_micros()) as f32 * 1.0e-6;
        let lasted_s = now_s - std::mem::replace(&mut self.last_s, now_s);
        self.remember(moment.pose);
        self.hear(moment.dirt, moment.now);
        if let Some(scan) = moment.scan {
            self.see(scan, now_s);
        }
        if let Some(people) = moment.people {
            self.see_people(people, now_s);
        }
        if let Some(floor) = moment.floor {
            self.see_floor(floor, now_s);
        }
        if self.phase == MissionPhase::Done {
            self.wish = Twist2::ZERO;
        } else if moment.is_paused {
            self.phase = MissionPhase::Paused;
            self.wish = Twist2::ZERO;
        } else {
            self.notice_hold(moment.decision, lasted_s);
            self.lost_s = if self.localiser.is_trusted() { 0.0 } else { self.lost_s + lasted_s };
            self.phase = if self.held_s > 0.5 { MissionPhase::Waiting } else { MissionPhase::Cleaning };
            self.wish = self.decide(now_s);
        }
        self.save(now_s);
        if now_s >= self.tell_s {
            self.tell_s = now_s + PROGRESS_S;
            self.watch.publish(Arc::new(self.progress(moment.now)));
        }
        self.wish
    }
}
