//! Watches a simulated run: feeds the judge, measures tracking, keeps what the report shows.

use std::sync::Arc;

use embassy_sync::blocking_mutex::raw::RawMutex;
use floorguard_drivers::can::CanFrame;
use floorguard_guard::{Cause, Health};
use floorguard_perception::people::TrackStatus;
use floorguard_runtime::digest::OutputDigest;
use floorguard_runtime::shared::{PeopleReport, RobotStatus, Shared, StopRecord};
use floorguard_runtime::tasks::PERSON_PROBABILITY_MIN;
use floorguard_sim::simulation::{Simulation, Truth as SimTruth};
use floorguard_types::geometry::{Point2, Pose2};
use floorguard_types::time::Stamp;

use super::observation::{Observation, PATH_US, SeenStop};
use super::swept_area::SweptArea;
use super::truth::TruthSampler;
use super::wheel_targets::WheelTargets;
use crate::judge::{Asked, Judge, Quantiles, Standing, StopOrders, StopReason, Verdict, known_us};
use crate::judge::{HeardOf, MissionJudge, NavigationJudge, TrueContacts};
use crate::metrics::MotAccumulator;
use crate::plan::Plan;
use floorguard_operator::panel::HeldHistory;
use floorguard_robot::camera::SeenDirt;
use floorguard_robot::cleaner::MissionProgress;
use floorguard_robot::environment::PeopleSeen;
use floorguard_robot::learning::LearningReport;
use floorguard_robot::navigator::NavigationProgress;

/// People farther away are not asked for, metres.
pub const TRACKED_RANGE_M: f32 = 12.0;
/// A track this near to a person whom something hides is not wrong, metres.
const HIDDEN_M: f32 = 1.0;
/// The list of people is kept at most this often.
const PEOPLE_US: u64 = 200_000;
/// Entries of the history of what held the robot.
const HISTORY_MAX: usize = 1_000;
/// A status comes every tenth tick, seconds.
const STATUS_S: f64 = 0.1;

/// Called now and then with the state of the robot.
pub type Show<'a> = &'a mut dyn FnMut(f64, &RobotStatus, usize, &[SeenStop]);

/// The watcher.
pub struct Observer<'a> {
    judge: Judge,
    truth_sampler: TruthSampler,
    orders: StopOrders,
    pressed: bool,
    digest: OutputDigest,
    learns: bool,
    seen_people: u32,
    seen_status: u32,
    seen_advice: u32,
    mot: MotAccumulator,
    pub(super) seen: Observation,
    targets: WheelTargets,
    odometry_in_world: Pose2,
    scenario: (String, u64),
    commanded_mps: f32,
    last_sweep: Option<Stamp>,
    swept: SweptArea,
    mission: Option<MissionJudge>,
    pub(super) navigation: Option<NavigationJudge>,
    last_status: Option<Stamp>,
    next_path_us: u64,
    next_speed_us: u64,
    people_now: usize,
    faulty: std::collections::BTreeSet<String>,
    show: Show<'a>,
    asked: Asked,
    standing: Standing,
    history: HeldHistory,
    /// What the robot's clock showed when the world began.
    clock_start: Stamp,
}

impl<'a> Observer<'a> {
    /// For a plan; `show` is called every 100 ms of robot time.
    pub fn new(plan: &Plan, show: Show<'a>) -> Self {
        Self {
            judge: Judge::new(&plan.robot, &plan.robot_parameters()),
            truth_sampler: TruthSampler::default(),
            orders: StopOrders::default(),
            pressed: false,
            digest: OutputDigest::default(),
            learns: plan.learning.is_some(),
            seen_people: 0,
            seen_status: 0,
            seen_advice: 0,
            mot: MotAccumulator::new(),
            seen: Observation::default(),
            targets: WheelTargets::of(&plan.robot),
            odometry_in_world: plan.odometry_in_world(),
            scenario: (plan.name.clone(), plan.seed),
            commanded_mps: 0.0,
            last_sweep: None,
            swept: SweptArea::new(plan.robot_parameters().brush),
            mission: None,
            navigation: None,
            last_status: None,
            next_path_us: 0,
            next_speed_us: 0,
            people_now: 0,
            faulty: std::collections::BTreeSet::new(),
            show,
            asked: Asked::of(plan),
            standing: Standing::default(),
            history: HeldHistory::default(),
            clock_start: Stamp::ZERO,
        }
    }

    /// The robot's clock showed this when the world began.
    pub const fn set_clock_start(&mut self, start: Stamp) {
        self.clock_start = start;
    }

    /// A moment of the robot's clock in the world's time.
    const fn in_world(&self, stamp: Stamp) -> Stamp {
        stamp.minus_micros(self.clock_start.as_micros())
    }

    /// A frame of the robot on the bus.
    pub fn on_frame(&mut self, frame: &CanFrame, now_us: u64) {
        self.digest.on_frame(frame, now_us);
        if let Some(commanded_mps) = self.targets.take(frame) {
            self.commanded_mps = commanded_mps;
            self.orders.order(now_us, self.commanded_mps);
        }
    }

    /// The emergency stop is pressed or not. When it is pressed, the truth says when; the robot learns of it later.
    pub fn on_emergency_stop(&mut self, pressed: bool, now_us: u64) {
        if pressed && !self.pressed {
            self.orders.stop(now_us, now_us);
        }
        self.pressed = pressed;
    }

    /// The tasks have run: what they put out goes into the fingerprint.
    pub fn after_tasks<M: RawMutex>(&mut self, shared: &Shared<M>) {
        let (people, status) = (shared.people.published(), shared.status.published());
        if self.seen_people != people
            && let Some(report) = shared.people.get()
        {
            self.seen_people = people;
            self.digest.on_people(&report);
            if self.learns {
                self.digest.on_probabilities(&report);
            }
        }
        if self.seen_status != status
            && let Some(report) = shared.status.get()
        {
            self.seen_status = status;
            self.digest.on_status(&report);
        }
        if let Some(advice) = shared.advice.unseen(&mut self.seen_advice) {
            self.seen.note_advice(advice.stamp.as_micros(), advice.people.len());
        }
    }

    /// A moment of 10 ms in which the robot's computer is off.
    pub fn observe_without_computer(&mut self, simulation: &Simulation) {
        (self.commanded_mps, self.targets.mps) = (0.0, [0.0; 4]);
        let truth = simulation.truth();
        self.judge.observe(simulation, (&self.truth_sampler.judged(simulation, &truth), 0.0));
        self.record_paths(truth.stamp.as_micros(), &truth);
        // A new life counts its publications from zero.
        (self.seen_people, self.seen_status, self.seen_advice) = (0, 0, 0);
    }

    /// A moment of 10 ms, and the stops that began since the one before.
    pub fn observe<M: RawMutex>(
        &mut self,
        simulation: &Simulation,
        shared: &Shared<M>,
        stops: &[StopRecord],
    ) {
        let truth = simulation.truth();
        let now_us = truth.stamp.as_micros();
        // The rim of the front wheel is faster than the middle of the rear axle.
        let commanded_mps = self.commanded_mps * libm::cosf(truth.steering_rad);
        self.judge.observe(simulation, (&self.truth_sampler.judged(simulation, &truth), commanded_mps));
        stops.iter().for_each(|stop| self.on_stop(stop, &truth));
        if let Some(people) = shared.people.get().filter(|people| self.last_sweep != Some(people.sweep.stamp))
        {
            self.last_sweep = Some(people.sweep.stamp);
            let believed = shared.pose.get().unwrap_or_default().pose_in_odometry;
            self.on_people(&people, &truth, believed);
        }
        if let Some(drive) = &mut self.navigation {
            drive.observe(&truth, shared.decision.get(), self.seen.ready_s.is_some());
        }
        self.seen.came.extend_from_slice(simulation.came().get(self.seen.came.len()..).unwrap_or_default());
        self.swept.touch(truth.robot);
        self.standing.observe(truth.stamp, truth.twist);
        self.record_paths(now_us, &truth);
        if let Some(status) = shared.status.get() {
            self.on_status(now_us, &status);
        }
    }

    /// The world before the run: what the judges know from the start.
    pub fn begin(&mut self, plan: &Plan, simulation: &Simulation) {
        match TrueContacts::new(plan, simulation) {
            Ok(bodies) => self.judge.begin(bodies),
            Err(error) => say!("  {error}: nobody judges contacts"),
        }
        self.mission = plan.mission.as_ref().map(|mission| MissionJudge::new(mission, simulation.dirt()));
        // Goals that somebody outside orders are judged by them.
        let own = plan.navigation.as_ref().filter(|_| plan.drive_orders.is_none());
        self.navigation = own.map(NavigationJudge::new);
    }

    /// The mission has reported its progress, while the robot believed in a pose of the odometry frame.
    pub fn on_mission(
        &mut self,
        progress: &Arc<MissionProgress>,
        (simulation, pose_in_odometry): (&Simulation, Pose2),
    ) {
        let truth = simulation.truth();
        let seconds = truth.stamp.as_micros() as f64 * 1.0e-6;
        if let Some(mission) = &mut self.mission {
            mission.observe(progress, (truth.robot, pose_in_odometry, seconds));
        }
    }

    /// The drive to a goal has reported its progress.
    pub fn on_navigation(&mut self, progress: &Arc<NavigationProgress>) {
        if let Some(drive) = &mut self.navigation {
            drive.hear(progress);
        }
    }

    /// What the floor camera saw of the dirt.
    pub fn on_seen_dirt(&mut self, seen: SeenDirt) {
        self.seen.seen_dirt = Some(seen);
    }

    /// What the robot learned.
    pub fn on_learning(&mut self, report: LearningReport) {
        self.seen.learned = Some(report);
    }

    /// The floor after a mission.
    pub fn finish_mission(&mut self, simulation: &Simulation) {
        self.seen.mission = self.mission.as_ref().and_then(|mission| mission.judge(simulation.dirt()));
    }

    fn on_status(&mut self, now_us: u64, status: &RobotStatus) {
        let seconds = now_us as f64 * 1.0e-6;
        let decision = &status.decision;
        // One that may leave what stands near it is ready, too.
        if decision.escaping || decision.speed_limit_mps > 0.0 && !decision.action.stops() {
            self.seen.ready_s.get_or_insert(seconds);
        }
        if self.last_status.replace(decision.stamp) != Some(decision.stamp) {
            let ready_for_s = if self.seen.ready_s.is_some() { STATUS_S } else { 0.0 };
            self.standing.held(status.decision.holding_cause, ready_for_s);
            if let Some(record) = status.decision.holding_cause {
                *self.seen.under_cause_s.entry(record.cause.to_string()).or_default() += STATUS_S;
            }
        }
        if self.seen.ready_s.is_some() {
            // A person at the bumper blinds the lidar: that is a reason to stand, not a fault of the device.
            let well = [Health::Healthy, Health::Blind];
            for report in
                status.sources.iter().filter(|report| report.fitted && !well.contains(&report.health))
            {
                self.faulty.insert(report.source.name().to_owned());
            }
        }
        if now_us >= self.next_speed_us {
            self.next_speed_us += 1_000_000;
            let limit_mps = status.decision.speed_limit_mps;
            self.seen.speeds.push((seconds, status.pose.twist.linear_mps, limit_mps));
        }
        let news = self.history.news(status).into_iter();
        let room = HISTORY_MAX.saturating_sub(self.seen.held.len());
        let heard = news.map(|event| HeardOf::of(self.in_world(event.at), &event));
        let heard: Vec<HeardOf> = heard.take(room).collect();
        self.seen.held.extend(heard);
        (self.show)(seconds, status, self.people_now, &self.seen.stops);
    }

    fn on_stop(&mut self, stop: &StopRecord, truth: &SimTruth) {
        let reason = match stop.cause.cause {
            Cause::ScanProtective | Cause::LidarProtective => StopReason::PathBlocked,
            Cause::CollisionStop => StopReason::PersonOnCourse,
            _ => StopReason::Other,
        };
        let stamp = self.in_world(stop.stamp);
        self.judge.stop(stamp, reason);
        let decided_us = stamp.as_micros();
        if stop.cause.cause != Cause::EmergencyStop {
            self.orders.stop(known_us(&stop.cause, decided_us), decided_us);
        }
        if let Cause::SourceLost(source) | Cause::SourceLate(source) = stop.cause.cause {
            self.faulty.insert(source.name().to_owned());
        }
        self.seen.stops.push(SeenStop {
            at_s: stamp.as_micros() as f64 * 1.0e-6,
            position: Point2::new(truth.robot.x_m, truth.robot.y_m),
            cause: stop.cause.to_string(),
            kind: stop.cause.cause.to_string(),
            speed_mps: stop.speed_mps,
        });
    }

    fn on_people(&mut self, report: &PeopleReport, truth: &SimTruth, believed: Pose2) {
        let to_world = truth.robot.compose(believed.inverse());
        let robot = Point2::new(truth.robot.x_m, truth.robot.y_m);
        let near = |place: Point2| place.distance(robot) < TRACKED_RANGE_M;
        let mut tracks = Vec::new();
        let mut seen_people = Vec::new();
        for person in &report.people {
            let counts = person.status == TrackStatus::Confirmed
                && person.person_probability >= PERSON_PROBABILITY_MIN
                && person.explanation.is_none();
            let place = to_world.transform(person.position);
            let hidden = truth.people.iter().filter(|person| !person.in_sight || !near(person.position));
            let excused = hidden.clone().any(|person| person.position.distance(place) < HIDDEN_M);
            if counts && near(place) {
                seen_people.push((u64::from(person.id), place));
            }
            if counts && near(place) && !excused {
                tracks.push((u64::from(person.id), place));
            }
        }
        let at_us = report.sweep.stamp.as_micros();
        if self.seen.people_seen.last().is_none_or(|last| at_us >= last.at_us.saturating_add(PEOPLE_US)) {
            self.seen.people_seen.push(PeopleSeen { at_us, robot: truth.robot, people: seen_people });
        }
        self.people_now = tracks.len();
        let seen = truth.people.iter().filter(|person| person.in_sight && near(person.position));
        let people: Vec<(u64, Point2)> = seen.map(|person| (u64::from(person.id), person.position)).collect();
        self.mot.frame(&people, &tracks);
    }

    fn record_paths(&mut self, now_us: u64, truth: &SimTruth) {
        if now_us < self.next_path_us {
            return;
        }
        self.next_path_us += PATH_US;
        self.seen.robot_path.push(truth.robot);
        for person in &truth.people {
            self.seen.people_paths.entry(person.id).or_default().push(person.position);
        }
    }

    /// The run has ended.
    pub fn finish(&mut self, resets: u32) {
        let summary = self.mot.summary();
        let (scenario, seed) = self.scenario.clone();
        self.seen.resets = resets;
        self.seen.cleaned_m2 = self.swept.area_m2();
        self.seen.verdict = Verdict {
            scenario,
            seed,
            mota: summary.mota,
            idf1: summary.idf1,
            id_switches: summary.switches as u32,
            localisation_error_m: summary.motp,
            stop_latency_ms: Quantiles::of_micros(self.orders.latencies_us().to_vec()),
            learned: self.seen.learned,
            mission: self.seen.mission.as_ref().map(|mission| mission.report.clone()),
            navigation: self.navigation.as_ref().map(NavigationJudge::judge),
            digest: format!("{:016x}", self.digest.value()),
            resets: self.seen.resets,
            held_back_s: self.seen.under_cause_s.clone(),
            history: self.seen.held.clone(),
            faulty_sources: self.faulty.iter().cloned().collect(),
            ..self.judge.verdict(self.seen.ready_s)
        };
        self.seen.verdict.conclude(self.asked, &self.standing);
    }

    /// The fingerprint of the outputs.
    #[must_use]
    pub const fn digest(&self) -> &OutputDigest {
        &self.digest
    }

    /// Everything seen.
    #[must_use]
    pub fn into_observation(self) -> Observation {
        self.seen
    }

    /// Where the odometry frame lies in the world.
    #[must_use]
    pub const fn odometry_in_world(&self) -> Pose2 {
        self.odometry_in_world
    }
}
