//! A drive to a goal judged by where the robot really was and when it really stood.

use std::collections::BTreeMap;
use std::sync::Arc;

use floorguard_guard::Decision;
use floorguard_robot::navigator::{
    NavigationPhase, NavigationPlan, NavigationProgress, StandingReason, SurveyedMap,
};
use floorguard_robot::site::Floor;
use floorguard_sim::simulation::Truth as SimTruth;
use floorguard_types::geometry::{Point2, Pose2, wrap_angle};
use serde::Serialize;

use super::exploration_outcome::ExplorationReport;
use super::standing_cause::StandingMoment;
use super::tour_outcome::{TourJudge, TourReport};

/// Slower than this is standing, m/s and rad/s.
const MOVES: (f32, f32) = (0.02, 0.02);
/// A truth is observed this often, seconds.
const STEP_S: f64 = 0.01;
/// The robot may stand for so long without a reason in one stretch: its wheel is turned across, a plan is made, seconds.
const UNREASONED_MAX_S: f64 = 3.0;
/// Allowed beyond the robot's tolerances, for the error of its own place: metres and radians.
const ALLOWED: (f32, f32) = (0.15, 0.1);

/// A robot that docks stands there within a centimetre and a degree, metres and radians. Nothing is allowed for its own errors.
const DOCKED: (f32, f32) = (0.01, 0.017_453);

/// What a drive came to.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct NavigationReport {
    /// The robot says that it is at the goal, and really is.
    pub reached: bool,
    /// The robot says so, and is not.
    pub false_claim: bool,
    /// What it was doing at the end.
    pub phase: String,
    /// In one sentence, as it says.
    pub reason: String,
    /// From its true place to the goal, metres.
    pub off_goal_m: f32,
    /// From its true heading to that of the goal, degrees.
    pub off_goal_deg: f32,
    /// The goal is the place where it began, to be met within a centimetre and a degree.
    #[serde(skip_serializing_if = "std::ops::Not::not")]
    pub docks: bool,
    /// What is left of its path, metres, if it has one.
    pub left_m: Option<f32>,
    /// From the moment it could move to the end, seconds.
    pub took_s: f64,
    /// Truly driven, metres.
    pub distance_m: f64,
    /// Over all that time, standing included, m/s.
    pub mean_speed_mps: f64,
    /// Share of that time in which it stood.
    pub standing_share: f64,
    /// How long it stood for which cause, seconds.
    pub standing_s: BTreeMap<String, f64>,
    /// The longest stretch in which it stood and named no true reason, seconds.
    pub unreasoned_s: f64,
    /// From its believed to its true place, the largest, metres.
    pub localisation_error_max_m: f32,
    /// Global plans.
    pub plans: u32,
    /// How often each measure of recovery was taken.
    pub measures: BTreeMap<String, u32>,
    /// What came of the tour, if there was one.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub tour: Option<TourReport>,
    /// What came of the map, if the robot was to make one.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub exploration: Option<ExplorationReport>,
}

impl NavigationReport {
    /// What was asked for and not reached.
    pub(super) fn shortfall(&self) -> Option<String> {
        if self.false_claim {
            return Some(format!(
                "the robot says that it is at the goal, and stands {} off it",
                self.off_words()
            ));
        }
        if let Some(shortfall) = self.stands_without_reason() {
            return Some(shortfall);
        }
        if let Some(shortfall) = self.tour.as_ref().and_then(TourReport::shortfall) {
            return Some(shortfall);
        }
        if let Some(exploration) = &self.exploration {
            return exploration.shortfall(&self.reason);
        }
        (!self.reached)
            .then(|| format!("the goal is not reached after {:.0} s: {}", self.took_s, self.reason))
    }

    fn off_words(&self) -> String {
        if self.docks {
            return format!("{:.1} mm and {:.2} degrees", 1_000.0 * self.off_goal_m, self.off_goal_deg);
        }
        format!("{:.2} m and {:.0} degrees", self.off_goal_m, self.off_goal_deg)
    }

    /// It stood too long and named no true reason.
    #[must_use]
    pub fn stands_without_reason(&self) -> Option<String> {
        (self.unreasoned_s > UNREASONED_MAX_S)
            .then(|| format!("the robot stood for {:.1} s and named no true reason", self.unreasoned_s))
    }

    /// The drive ended because the robot gave up and asked for a person.
    #[must_use]
    pub fn calls_help(&self) -> bool {
        [NavigationPhase::NeedsHelp, NavigationPhase::Unreachable]
            .iter()
            .any(|phase| self.phase == phase.name())
    }

    /// In one line, for people.
    #[must_use]
    pub fn words(&self) -> String {
        let end = match (&self.exploration, &self.tour) {
            (Some(exploration), _) => exploration.words(),
            (None, Some(tour)) => tour.words(),
            (None, None) => {
                format!("{} off the goal", self.off_words())
            }
        };
        format!(
            "{} after {:.0} s, {:.1} m driven, {:.2} m/s in the mean, stood {:.0} % of the time; {end}",
            self.phase,
            self.took_s,
            self.distance_m,
            self.mean_speed_mps,
            100.0 * self.standing_share,
        )
    }
}

/// Watches a drive beside the truth.
#[derive(Clone, Debug)]
pub struct NavigationJudge {
    goal: Pose2,
    within: (f32, f32),
    newest: Option<Arc<NavigationProgress>>,
    robot: Pose2,
    report: NavigationReport,
    standing_s: f64,
    stretch_s: f64,
    tour: Option<TourJudge>,
}

impl NavigationJudge {
    /// For a plan.
    #[must_use]
    pub fn new(plan: &NavigationPlan) -> Self {
        let within = (plan.settings.within_m + ALLOWED.0, plan.settings.within_rad + ALLOWED.1);
        let within = if plan.docks { DOCKED } else { within };
        let last = plan.places_in_map().last().copied().unwrap_or_else(|| plan.goal_pose());
        Self {
            goal: if plan.docks { plan.start_pose() } else { last },
            within,
            newest: None,
            robot: plan.start_pose(),
            report: NavigationReport { docks: plan.docks, ..NavigationReport::default() },
            standing_s: 0.0,
            stretch_s: 0.0,
            tour: TourJudge::of(&plan.places_in_map(), within),
        }
    }

    /// The map that the robot made.
    pub fn take_survey(&mut self, surveyed: &SurveyedMap, floor: &Floor) {
        let ended = self.newest.as_ref().is_some_and(|newest| newest.phase == NavigationPhase::Explored);
        self.report.exploration = Some(ExplorationReport::of(surveyed, floor, ended));
    }

    /// The robot reported its progress.
    pub fn hear(&mut self, progress: &Arc<NavigationProgress>) {
        let believed = progress.pose_in_map;
        let off_m =
            Point2::new(believed.x_m, believed.y_m).distance(Point2::new(self.robot.x_m, self.robot.y_m));
        self.report.localisation_error_max_m = self.report.localisation_error_max_m.max(off_m);
        self.newest = Some(Arc::clone(progress));
    }

    /// A moment of 10 ms; `is_ready`: the robot could move before.
    pub fn observe(&mut self, truth: &SimTruth, decision: Option<Decision>, is_ready: bool) {
        let before = std::mem::replace(&mut self.robot, truth.robot);
        if !is_ready {
            return;
        }
        self.report.took_s += STEP_S;
        let step_m = (truth.robot.x_m - before.x_m).hypot(truth.robot.y_m - before.y_m);
        self.report.distance_m += f64::from(step_m);
        let stands = truth.twist.linear_mps.abs() < MOVES.0 && truth.twist.angular_radps.abs() < MOVES.1;
        if let Some(tour) = &mut self.tour {
            tour.observe(truth.robot, stands.then_some(STEP_S));
        }
        if !stands {
            self.stretch_s = 0.0;
            return;
        }
        self.standing_s += STEP_S;
        let reason = self.newest.as_ref().and_then(|progress| progress.standing);
        let is_true = reason.is_some_and(|reason| is_true(reason, decision));
        let moment = StandingMoment {
            reason: reason.filter(|_| is_true),
            decision,
            nearest_person_m: truth.nearest_person_m,
        };
        *self.report.standing_s.entry(moment.cause()).or_default() += STEP_S;
        self.stretch_s = if is_true { 0.0 } else { self.stretch_s + STEP_S };
        self.report.unreasoned_s = self.report.unreasoned_s.max(self.stretch_s);
    }

    /// The end.
    #[must_use]
    pub fn judge(&self) -> NavigationReport {
        let mut report = self.report.clone();
        let took_s = report.took_s.max(STEP_S);
        report.mean_speed_mps = report.distance_m / took_s;
        report.standing_share = self.standing_s / took_s;
        let (goal, robot) = (self.goal, self.robot);
        report.off_goal_m = Point2::new(robot.x_m, robot.y_m).distance(Point2::new(goal.x_m, goal.y_m));
        let off_rad = wrap_angle(robot.heading_rad - goal.heading_rad).abs();
        report.off_goal_deg = off_rad.to_degrees();
        let is_there = report.off_goal_m <= self.within.0 && off_rad <= self.within.1;
        let Some(progress) = &self.newest else {
            "starting".clone_into(&mut report.phase);
            "the drive never began".clone_into(&mut report.reason);
            return report;
        };
        report.tour = self.tour.as_ref().map(|tour| tour.judge(progress.tour.unwrap_or_default()));
        let is_there = report.tour.as_ref().map_or(is_there, TourReport::is_whole);
        let claims = progress.phase == NavigationPhase::Reached;
        (report.reached, report.false_claim) =
            (claims && is_there, claims && !is_there && report.tour.is_none());
        report.reached |= progress.phase == NavigationPhase::Explored;
        progress.phase.name().clone_into(&mut report.phase);
        report.reason.clone_from(&progress.words);
        report.left_m = progress.left_m;
        report.plans = progress.plans;
        let counts = progress.measures.iter();
        report.measures = counts.map(|(words, count)| ((*words).to_owned(), *count)).collect();
        report
    }
}

/// A robot that says that the guard holds it is believed only while the guard does.
fn is_true(reason: StandingReason, decision: Option<Decision>) -> bool {
    match reason {
        StandingReason::Guard(_) => decision.is_none_or(|decision| {
            let permitted = decision.permitted;
            permitted.linear_mps.abs() < MOVES.0 && permitted.angular_radps.abs() < 2.0 * MOVES.1
        }),
        _ => true,
    }
}
