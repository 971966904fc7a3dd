//! The drive itself: senses, costmaps, plan, steering, and what to do when the robot does not come forward.

use std::collections::BTreeMap;
use std::sync::Arc;

use floorguard_guard::Decision;
use floorguard_navigation::global::{PlanFailure, PlanState, check_plan};
use floorguard_navigation::local::{LocalCommand, LocalVerdict};
use floorguard_navigation::recovery::{Measure, Obstruction, Recovery, RecoveryMoment, RecoveryStep, Trail};
use floorguard_runtime::configuration::RobotConfiguration;
use floorguard_runtime::tasks::{Mission, MissionMoment};
use floorguard_types::geometry::{Pose2, Twist2};
use floorguard_types::motion::{MovingPerson, Waypoint};
use floorguard_types::time::Stamp;

use super::course::Course;
use super::docking::Docking;
use super::exploring::Exploring;
use super::goal_search::GoalSearch;
use super::goals::{DriveOrders, WayLimits};
use super::guard_model::{GuardModel, place_of};
use super::maps::Maps;
use super::model::{Model, PERIOD_S, times_of};
use super::plan::{Journey, NavigationPlan};
use super::progress::{CostmapImage, NavigationPhase, SharedNavigationWatch};
use super::reasons::{StandingReason, is_standing};
use super::senses::Senses;
use super::setup::NavigationSetup;
use super::space_inbox::SpaceInbox;
use super::steering::{Steering, SteeringMoment, is_followed};
use super::touring::Tour;

/// The global costs are made anew this often, seconds.
const REFRESH_S: f32 = 1.0;
/// After so long a path is planned anew even if it is free: what was in the way may have gone, seconds.
const OLD_S: f32 = 10.0;
/// Farther off its path the robot plans anew, metres.
const OFF_M: f32 = 0.8;
/// A plan that failed is tried again after, seconds.
const RETRY_S: f32 = 1.0;
/// Held by the guard for this long counts as an obstruction, seconds.
const HELD_S: f32 = 1.0;
/// Held for this long while it backs out, the robot asks to back out straight, seconds.
const STRAIGHT_S: f32 = 0.3;
/// For so long the robot stands to find itself; after that it drives on, which shows it more, seconds.
const FINDS_S: f32 = 6.0;

/// A drive to a goal.
pub struct Navigator {
    pub(super) plan: NavigationPlan,
    pub(super) model: Model,
    pub(super) senses: Senses,
    pub(super) maps: Maps,
    pub(super) space: SpaceInbox,
    pub(super) search: GoalSearch,
    pub(super) course: Course,
    pub(super) steering: Steering,
    pub(super) guard: GuardModel,
    pub(super) recovery: Recovery,
    pub(super) trail: Trail,
    pub(super) back: Vec<Waypoint>,
    pub(super) phase: NavigationPhase,
    pub(super) failure: Option<PlanFailure>,
    pub(super) is_proved: bool,
    pub(super) step: Option<RecoveryStep>,
    pub(super) requested: Twist2,
    pub(super) standing: Option<StandingReason>,
    pub(super) exploring: Option<Exploring>,
    pub(super) watch: SharedNavigationWatch,
    pub(super) began: Option<Stamp>,
    pub(super) last_s: f32,
    pub(super) next_s: f32,
    pub(super) next_refresh_s: f32,
    pub(super) next_plan_s: f32,
    pub(super) planned_s: f32,
    pub(super) held_s: f32,
    pub(super) leaves_straight: bool,
    pub(super) lost_s: f32,
    pub(super) plans: u32,
    pub(super) measures: BTreeMap<&'static str, u32>,
    pub(super) costmap: Option<Arc<CostmapImage>>,
    pub(super) next_report_s: f32,
    pub(super) next_costmap_s: f32,
    pub(super) reported: Option<(NavigationPhase, bool)>,
    pub(super) orders: Option<DriveOrders>,
    pub(super) goal_number: u32,
    pub(super) way: WayLimits,
    pub(super) tour: Option<Tour>,
    pub(super) docking: Option<Docking>,
}

impl Navigator {
    /// Ready to begin.
    ///
    /// # Errors
    /// The map has no floor for this robot, or is too large.
    pub fn new(setup: &NavigationSetup, robot: &RobotConfiguration) -> anyhow::Result<Self> {
        let NavigationSetup { plan, watch, survey, space, orders } = setup;
        let map = plan.occupancy()?;
        let model = Model::of(robot, &plan.settings, map.geometry().resolution_m().max(0.05))?;
        let mut maps = Maps::new(&map, &model.inflation, plan)?;
        maps.start_at(place_of(plan.start_pose()), model.outline.circumscribed_radius_m());
        let search = GoalSearch::new(maps.geometry(), &model)?;
        let steering = Steering::new(&model, &plan.settings, (maps.window_cells(), plan.seed));
        let senses = Senses::new(plan, robot, (model.outline.inscribed_radius_m(), survey.as_ref()))?;
        Ok(Self {
            docking: plan.docks.then(|| Docking::new(robot, senses.scanner_in_base())),
            senses,
            exploring: plan.explores.then(|| Exploring::new(maps.geometry())).transpose()?,
            guard: GuardModel::of(robot),
            plan: plan.clone(),
            model,
            maps,
            space: space.clone(),
            search,
            course: Course::default(),
            steering,
            recovery: Recovery::new(times_of(&plan.settings)),
            trail: Trail::default(),
            back: Vec::new(),
            phase: if orders.is_some() { NavigationPhase::Waiting } else { NavigationPhase::Starting },
            failure: None,
            // A map that is empty proves nothing.
            is_proved: plan.explores,
            step: None,
            requested: Twist2::ZERO,
            standing: Some(StandingReason::Starting),
            watch: watch.clone(),
            began: None,
            last_s: 0.0,
            next_s: 0.0,
            next_refresh_s: 0.0,
            next_plan_s: 0.0,
            planned_s: 0.0,
            held_s: 0.0,
            leaves_straight: false,
            lost_s: 0.0,
            plans: 0,
            measures: BTreeMap::new(),
            costmap: None,
            next_report_s: 0.0,
            next_costmap_s: 0.0,
            reported: None,
            orders: orders.clone(),
            goal_number: 0,
            way: WayLimits::NONE,
            tour: Tour::of(&plan.tour),
        })
    }

    /// Looks after the global plan: on fresh costs, blocked, old or left.
    fn keep_course(&mut self, pose: Pose2, now_s: f32) {
        let off_m = self.course.follow(pose);
        let is_refreshed = now_s >= self.next_refresh_s;
        if is_refreshed {
            self.next_refresh_s = now_s + REFRESH_S;
            self.maps.refresh();
        }
        let is_blocked = is_refreshed && self.is_blocked();
        let is_old = now_s - self.planned_s > OLD_S && !self.course.gear().is_some_and(is_followed);
        let is_left = off_m > OFF_M;
        let is_needed = self.course.gear().is_none() || is_blocked || is_left || is_old;
        if is_needed && now_s >= self.next_plan_s {
            self.plan_anew(pose, now_s);
        }
    }

    fn is_blocked(&self) -> bool {
        let (Some(costmap), Some(plan)) = (self.maps.global(), self.course.plan()) else { return false };
        let state = check_plan(costmap, self.search.least(), (plan, self.course.rest()));
        matches!(state, PlanState::Blocked { .. })
    }

    /// Plans from here to the goal. A path that fails by the map alone fails for good.
    pub(super) fn plan_anew(&mut self, pose: Pose2, now_s: f32) {
        self.next_plan_s = now_s + RETRY_S;
        self.planned_s = now_s;
        self.plans = self.plans.saturating_add(1);
        let goal = self.plan.goal_pose();
        let Some(costmap) = self.maps.global() else { return };
        match self.search.plan(costmap, Journey { start_in_map: pose, goal_in_map: goal }) {
            Ok((plan, mut path)) => {
                // The lattice ends near the goal; the rest is the local planner's.
                if let Some(last) = path.last_mut() {
                    last.pose_in_map = goal;
                }
                self.failure = None;
                self.is_proved = true;
                self.course = Course::new(plan, path);
                if self.course.gear().is_none() {
                    // Too near for the lattice.
                    self.course.end_at((pose, goal));
                }
                self.steering.restart();
            }
            Err(failure) => {
                self.failure = Some(failure);
                self.course = Course::default();
                self.exploring.iter_mut().for_each(|exploring| exploring.note_failure(failure));
                if !self.is_proved {
                    self.prove(pose, goal);
                }
            }
        }
    }

    /// Whether the map alone has a path; asked once, at the beginning.
    fn prove(&mut self, pose: Pose2, goal: Pose2) {
        self.is_proved = true;
        self.maps.refresh_by_map_alone();
        let outcome = self.maps.global().map(|costmap| {
            self.search.plan(costmap, Journey { start_in_map: pose, goal_in_map: goal }).map(drop)
        });
        self.maps.refresh();
        if let Some(Err(failure)) = outcome
            && failure != PlanFailure::StartBlocked
        {
            self.failure = Some(failure);
            self.phase = NavigationPhase::Unreachable;
        }
    }

    /// The command along the course.
    fn drive(&mut self, pose: Pose2, people: &[MovingPerson]) -> LocalCommand {
        let hills = if self.steering.needs_people_in_costmap() { people } else { &[] };
        self.maps.roll(place_of(pose), hills);
        let Some(costmap) = self.maps.window() else { return LocalCommand::stand(LocalVerdict::NoPath) };
        let twist = self.senses.motion().twist;
        let moment = SteeringMoment { pose_in_map: pose, twist, costmap, people, guard: &self.guard };
        if !self.back.is_empty() {
            return self.steering.follow(&moment, &self.back);
        }
        // A piece that ends at once is followed by the next one.
        for _ in 0..3 {
            let Some(gear) = self.course.gear() else { break };
            let command = if is_followed(gear) {
                self.steering.follow(&moment, self.course.whole_piece())
            } else {
                self.steering.ahead(&moment, self.course.piece())
            };
            match command.verdict {
                LocalVerdict::Arrived if !self.course.is_last() => self.course.next_piece(),
                LocalVerdict::Arrived if !self.is_at_goal(pose) => {
                    self.course.end_at((pose, self.plan.goal_pose()))
                }
                LocalVerdict::NoPath => {
                    self.course = Course::default();
                    break;
                }
                _ => return command,
            }
        }
        LocalCommand::stand(LocalVerdict::NoPath)
    }

    fn obstruction(&self, command: &LocalCommand) -> Option<Obstruction> {
        let is_slow = is_standing(command.twist);
        match command.verdict {
            _ if self.lost_s > 0.0 && self.lost_s < FINDS_S => Some(Obstruction::Lost),
            _ if self.course.gear().is_none() => self.failure.map(Obstruction::NoPath),
            LocalVerdict::Blocked => Some(Obstruction::NoVelocity),
            LocalVerdict::Driving if is_slow => Some(Obstruction::Yields),
            _ if self.held_s > HELD_S => Some(Obstruction::Held),
            _ => None,
        }
    }

    /// What to do about what obstructs the robot.
    fn recover(&mut self, command: &LocalCommand, (pose, now_s): (Pose2, f32)) {
        let is_backing = !self.back.is_empty();
        let is_done = self.step.is_some_and(|step| step.measure == Measure::BackOut) && !is_backing
            || is_backing && matches!(command.verdict, LocalVerdict::Arrived | LocalVerdict::NoPath);
        let left_m = self.course.gear().map(|_| self.course.left_m());
        let obstruction = self.obstruction(command);
        let place_in_map = place_of(pose);
        let moment = RecoveryMoment { lasted_s: PERIOD_S, place_in_map, obstruction, left_m, is_done };
        let step = self.recovery.update(&moment);
        self.step = Some(step);
        if step.measure != Measure::BackOut && is_backing {
            self.back.clear();
            self.steering.restart();
        }
        if !step.is_new {
            return self.straighten_backing(pose);
        }
        if step.measure != Measure::Drive {
            *self.measures.entry(step.measure.words()).or_default() += 1;
        }
        match step.measure {
            Measure::ClearCostmap => {
                self.forget_around(place_of(pose));
                (self.next_refresh_s, self.next_plan_s) = (now_s + 0.3, now_s + 0.3);
                self.course = Course::default();
            }
            Measure::BackOut => self.begin_backing(pose),
            Measure::OtherWay => {
                let ahead = pose.compose(Pose2::new(1.2, 0.0, 0.0));
                self.maps.avoid(place_of(ahead));
                self.maps.refresh();
                self.plan_anew(pose, now_s);
            }
            Measure::Drive | Measure::Wait | Measure::CallHelp => {}
        }
    }

    /// One period: plan, steer, recover.
    fn decide(&mut self, now_s: f32) -> Twist2 {
        let pose = self.senses.pose();
        self.maps.stand_on(&self.model.outline, pose);
        self.choose_goal(pose, now_s);
        if self.observe_here(pose, now_s) {
            return Twist2::ZERO;
        }
        if let Some(twist) = self.dock() {
            return twist;
        }
        if self.learns_dock() || self.has_arrived(pose) || self.phase.stands() {
            return Twist2::ZERO;
        }
        if self.back.is_empty() {
            self.trail.note(pose);
        }
        self.keep_course(pose, now_s);
        if self.phase == NavigationPhase::Unreachable {
            return Twist2::ZERO;
        }
        let people = self.senses.people_in_map(now_s);
        self.guard.meet(&people, place_of(pose));
        let command = self.drive(pose, &people);
        self.recover(&command, (pose, now_s));
        if self.step.is_some_and(|step| step.measure == Measure::CallHelp) {
            self.phase = NavigationPhase::NeedsHelp;
        } else if command.verdict != LocalVerdict::NoPath {
            self.phase = NavigationPhase::Driving;
        }
        if self.lost_s > 0.0 && self.lost_s < FINDS_S {
            Twist2::ZERO
        } else {
            self.permitted_way(command.twist)
        }
    }

    /// From what is in its fields the guard lets a robot leave straight only.
    fn permitted_way(&mut self, twist: Twist2) -> Twist2 {
        self.leaves_straight = twist.linear_mps < 0.0 && (self.leaves_straight || self.held_s > STRAIGHT_S);
        Twist2 { angular_radps: if self.leaves_straight { 0.0 } else { twist.angular_radps }, ..twist }
    }

    /// The guard permits nothing of what is requested.
    fn notice_hold(&mut self, decision: Option<Decision>, lasted_s: f32) {
        let wants = !is_standing(self.requested);
        let is_held = decision.is_none_or(|decision| is_standing(decision.permitted));
        self.held_s = if wants && is_held { self.held_s + lasted_s } else { 0.0 };
    }
}

impl Mission for Navigator {
    fn step(&mut self, moment: &MissionMoment<'_>) -> Twist2 {
        let began = *self.began.get_or_insert(moment.now);
        let now_s = moment.now.as_micros().saturating_sub(began.as_micros()) as f32 * 1.0e-6;
        let lasted_s = now_s - std::mem::replace(&mut self.last_s, now_s);
        self.senses.remember(moment.pose);
        self.take_orders();
        if let Some(people) = moment.people {
            self.senses.see_people(people, (moment.now, now_s));
        }
        if let Some(scan) = moment.scan {
            let (sensor, beams) = self.senses.see(scan, now_s);
            if let Some(scans) = self.senses.take_redrawn() {
                self.maps.redraw(&scans);
            }
            self.maps.see(sensor, &beams);
            self.see_dock(scan);
        }
        if let Some(sight) = self.space.take() {
            let rays = self.senses.rays_in_map(&sight, now_s);
            self.maps.see_space(&rays);
        }
        self.notice_hold(moment.decision, lasted_s);
        self.lost_s = if self.senses.is_trusted() { 0.0 } else { self.lost_s + lasted_s };
        if moment.is_paused || self.phase.stands() {
            self.requested = Twist2::ZERO;
        } else if now_s >= self.next_s {
            self.next_s = now_s + PERIOD_S - 0.001;
            self.requested = self.decide(now_s);
            self.requested = self.way.limit(self.requested);
            self.leave_out_unreachable();
        }
        self.standing = self.standing_reason(moment);
        self.report(moment, now_s);
        self.requested
    }
}
