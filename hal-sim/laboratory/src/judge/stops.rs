//! Stops that were missed, stops that were not needed, and how fast the needed ones came.

use floorguard_runtime::configuration::{Limits, RobotConfiguration};
use floorguard_sim::robot::RobotParameters;
use floorguard_types::geometry::{Point2, Pose2};

use super::scanner_view::ScannerView;
use super::shape::distance_m;
use super::truth::Truth;
use super::zone::{STANDING_MPS, TrueZones};

/// Time from an intrusion to an answering command that the design allows, seconds: two scans of 40 ms, one scan of
/// transfer, a tick, one scan because scan and intrusion are not in step, and one scan that may be lost.
const REACTION_S: f32 = 0.22;
/// An intrusion of less than this is within the scanner's tolerance and proves nothing, metres.
const TOLERANCE_M: f32 = 0.05;
/// A stop is a nuisance only when nothing came within this of the zone, metres (Z_G 0.10 m and the leg's radius).
const NUISANCE_MARGIN_M: f32 = 0.15;
/// How far back an intrusion explains a stop, seconds: the reaction time and the field switching back.
const EXPLAINS_S: f32 = 1.0;

/// A person who would touch the robot within this time, both going on as they do, is on course, seconds: the time to
/// stand still from full speed, and the margin of half a second that the guard adds (book, Guard: Collision).
const COURSE_S: f32 = 2.0;
/// Nobody can tell a miss by less than this from a hit, metres: half a step.
const COURSE_MARGIN_M: f32 = 0.4;
/// Steps in which both are moved on.
const COURSE_STEPS: u16 = 20;

/// Moves everybody on in straight lines, the robot on its arc.
fn person_on_course(footprint: &[Point2], truth: &Truth) -> bool {
    (0..=COURSE_STEPS).any(|step| {
        let ahead_s = COURSE_S * f32::from(step) / f32::from(COURSE_STEPS);
        let turned_rad = truth.twist.angular_radps * ahead_s;
        let driven_m = truth.twist.linear_mps * ahead_s;
        let half = turned_rad / 2.0;
        let moved = Pose2::new(driven_m * half.cos(), driven_m * half.sin(), turned_rad);
        let to_robot = truth.robot.compose(moved).inverse();
        truth.people.iter().any(|person| {
            let there = Point2::new(
                person.position.x_m + person.velocity_mps.x_m * ahead_s,
                person.position.y_m + person.velocity_mps.y_m * ahead_s,
            );
            distance_m(footprint, to_robot.transform(there)) < person.radius_m + COURSE_MARGIN_M
        })
    })
}

/// Simulated people who do not look walk on through a robot that stands on their path, which no real body can. That
/// they touched it is the business of the judge of contacts; who is inside its body is no intrusion into its field.
fn without_bodies_inside(truth: &Truth, footprint: &[Point2]) -> Truth {
    let mut truth = truth.clone();
    let to_robot = truth.robot.inverse();
    for person in &mut truth.people {
        person.ground.retain(|(middle, _)| distance_m(footprint, to_robot.transform(*middle)) > 0.0);
    }
    truth
}

/// Why the robot says it stopped; only stops for an obstacle can be a nuisance.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum StopReason {
    /// A protective field was violated.
    PathBlocked,
    /// A person would be reached.
    PersonOnCourse,
    /// Anything else: start, operator, fault, end of the route.
    Other,
}

/// Watches intrusions and stops.
pub struct StopJudge {
    zones: TrueZones,
    scanners: Vec<ScannerView>,
    footprint: Vec<Point2>,
    limits: Limits,
    intruded_since_s: Option<(f32, f32)>,
    last_near_s: f32,
    last_course_s: f32,
    missed_this_time: bool,
    missed: u32,
    nuisance: u32,
    stops: u32,
    latencies_us: Vec<u64>,
    awaiting_command: bool,
}

impl StopJudge {
    /// For a robot, and what is fixed about the true one.
    #[must_use]
    pub fn new(robot: &RobotConfiguration, parameters: &RobotParameters) -> Self {
        Self {
            zones: TrueZones::new(robot),
            scanners: ScannerView::all(parameters),
            limits: robot.limits,
            intruded_since_s: None,
            last_near_s: f32::MIN,
            last_course_s: f32::MIN,
            footprint: robot.geometry.footprint.iter().copied().collect(),
            missed_this_time: false,
            missed: 0,
            nuisance: 0,
            stops: 0,
            latencies_us: Vec::new(),
            awaiting_command: false,
        }
    }

    /// Processes the next sample. `commanded_mps` is the last command to the drive.
    pub fn observe(&mut self, truth: &Truth, commanded_mps: f32) {
        let seconds = truth.stamp.as_micros() as f32 * 1.0e-6;
        let speed_mps = truth.twist.linear_mps;
        let zone_speed_mps = if speed_mps.abs() > commanded_mps.abs() { speed_mps } else { commanded_mps };
        let Some(pair) = self.zones.applying(zone_speed_mps) else { return };
        // The warning field counts too: time-to-collision stops come before the protective field.
        if TrueZones::nearness_m(&pair.warning, truth) > -NUISANCE_MARGIN_M {
            self.last_near_s = seconds;
        }
        if person_on_course(&self.footprint, truth) {
            self.last_course_s = seconds;
        }
        let mut truth = without_bodies_inside(truth, &self.footprint);
        // What no scanner looks at is the business of the judge of contacts, too: its own fields cannot answer it.
        truth.obstacles_in_robot.retain(|point| self.scanners.iter().any(|scanner| scanner.covers(*point)));
        let truth = &truth;
        let moving = speed_mps.abs() > STANDING_MPS;
        let true_pair = self.zones.applying(speed_mps);
        let depth_m = true_pair.map_or(f32::MIN, |pair| TrueZones::intrusion_m(&pair.protective, truth));
        if !moving || depth_m < TOLERANCE_M {
            self.intruded_since_s = None;
            self.missed_this_time = false;
            self.awaiting_command = false;
            return;
        }
        if self.intruded_since_s.is_none() {
            self.intruded_since_s = Some((seconds, speed_mps.abs()));
            self.awaiting_command = commanded_mps.abs() > STANDING_MPS;
        }
        // A slower command answers the intrusion too when its smaller zone is free.
        let commanded_pair = self.zones.applying(commanded_mps);
        let answered = commanded_mps.abs() < STANDING_MPS
            || commanded_pair
                .is_some_and(|pair| TrueZones::intrusion_m(&pair.protective, truth) < TOLERANCE_M);
        self.judge_intrusion(seconds, answered);
    }

    fn judge_intrusion(&mut self, seconds: f32, answered: bool) {
        let Some((since_s, entry_mps)) = self.intruded_since_s else { return };
        if self.awaiting_command && answered {
            self.latencies_us.push(((seconds - since_s).max(0.0) * 1.0e6) as u64);
            self.awaiting_command = false;
        }
        let allowed_s = REACTION_S + self.limits.response_s + entry_mps / self.limits.braking_mps2.max(0.01);
        if seconds - since_s > allowed_s && !self.missed_this_time {
            self.missed_this_time = true;
            self.missed += 1;
        }
    }

    /// The robot decided to stop.
    pub fn stop(&mut self, at_s: f32, reason: StopReason) {
        self.stops += 1;
        let explained_s = match reason {
            StopReason::PathBlocked => self.last_near_s,
            StopReason::PersonOnCourse => self.last_near_s.max(self.last_course_s),
            StopReason::Other => return,
        };
        if at_s - explained_s > EXPLAINS_S {
            self.nuisance += 1;
        }
    }

    /// Intrusions that no command answered in time, or in which the robot went on for longer than braking takes.
    #[must_use]
    pub const fn missed(&self) -> u32 {
        self.missed
    }

    /// Stops for an obstacle while there was none.
    #[must_use]
    pub const fn nuisance(&self) -> u32 {
        self.nuisance
    }

    /// All stops.
    #[must_use]
    pub const fn stops(&self) -> u32 {
        self.stops
    }

    /// From intrusion to the stop command, microseconds.
    #[must_use]
    pub fn latencies_us(&self) -> &[u64] {
        &self.latencies_us
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::judge::TruthPerson;
    use floorguard_configuration::{EXAMPLE, parse};
    use floorguard_sim::robot::SensorMount;
    use floorguard_types::geometry::Twist2;
    use floorguard_types::time::Stamp;

    /// A robot at 0.8 m/s towards a wall; from `brakes_s` on it is commanded to stop and brakes as specified.
    fn approach(brakes_s: f32) -> StopJudge {
        approach_to(0.0, brakes_s, &example())
    }

    fn example() -> RobotConfiguration {
        parse("robot.toml", EXAMPLE).unwrap().robot
    }

    /// The same towards a post at the side of the way.
    fn approach_to(post_y_m: f32, brakes_s: f32, robot: &RobotConfiguration) -> StopJudge {
        let mut judge = StopJudge::new(robot, &RobotParameters::default());
        let (mut x_m, mut speed_mps) = (0.0, 0.8_f32);
        for step in 0..600_u64 {
            let seconds = step as f32 * 0.01;
            let commanded_mps = if seconds >= brakes_s { 0.0 } else { 0.8 };
            if seconds >= brakes_s + 0.15 {
                speed_mps = (speed_mps - 0.8 * 0.01).max(0.0);
            }
            x_m += speed_mps * 0.01;
            let truth = Truth {
                stamp: Stamp::from_micros(step * 10_000),
                robot: Pose2::new(x_m, 0.0, 0.0),
                twist: Twist2 { linear_mps: speed_mps, angular_radps: 0.0 },
                obstacles_in_robot: vec![Point2::new(5.0 - x_m, post_y_m)],
                ..Truth::default()
            };
            judge.observe(&truth, commanded_mps);
        }
        judge
    }

    #[test]
    fn only_a_late_stop_is_missed() {
        // The zone of 0.8 m/s reaches x = 2.3 m: the wall at 5 m enters it at 3.38 s, 5 cm deep at 3.44 s.
        assert_eq!(approach(3.52).missed(), 0);
        assert_eq!(approach(4.3).missed(), 1);
        let latency_us = approach(3.52).latencies_us()[0];
        assert!((60_000..=100_000).contains(&latency_us), "{latency_us}");
    }

    /// A robot that creeps backwards to a post, and goes on: intrusions that were not answered.
    fn missed_behind(parameters: &RobotParameters) -> u32 {
        let mut judge = StopJudge::new(&example(), parameters);
        for step in 0..600_u64 {
            let x_m = -0.1 * step as f32 * 0.01;
            let truth = Truth {
                stamp: Stamp::from_micros(step * 10_000),
                robot: Pose2::new(x_m, 0.0, 0.0),
                twist: Twist2 { linear_mps: -0.1, angular_radps: 0.0 },
                obstacles_in_robot: vec![Point2::new(-1.0 - x_m, 0.0)],
                ..Truth::default()
            };
            judge.observe(&truth, -0.1);
        }
        judge.missed()
    }

    #[test]
    fn only_what_scanners_cover_must_be_answered() {
        let mut parameters = RobotParameters::default();
        assert_eq!(missed_behind(&parameters), 0, "its scanner looks to the front");
        let at_rear = SensorMount { x_m: -0.3, y_m: 0.0, z_m: 0.15, yaw_rad: core::f32::consts::PI };
        parameters.rear_scanner = Some(at_rear);
        assert_eq!(missed_behind(&parameters), 1, "one at the rear looks there");
    }

    /// What the robot's file leaves out of the scanner's sector is judged all the same.
    #[test]
    fn needle_of_a_sector_excuses_nothing() {
        let mut robot = example();
        assert_eq!(approach_to(0.35, 4.3, &robot).missed(), 1);
        robot.scanner.sector_rad = [-0.1, 0.1];
        assert_eq!(approach_to(0.35, 4.3, &robot).missed(), 1);
    }

    #[test]
    fn intrusion_counts_at_edge_not_inside() {
        let judge = approach(3.65);
        let person =
            |x_m: f32| TruthPerson { ground: vec![(Point2::new(x_m, 0.0), 0.06)], ..TruthPerson::default() };
        // The body reaches to 0.95 m.
        let truth = Truth { people: vec![person(0.5), person(0.96)], ..Truth::default() };
        let left = without_bodies_inside(&truth, &judge.footprint);
        assert_eq!(left.people.iter().map(|person| person.ground.len()).collect::<Vec<_>>(), [0, 1]);
    }

    #[test]
    fn a_stop_without_anything_near_is_a_nuisance() {
        let mut judge = approach(3.65);
        judge.stop(3.65, StopReason::PathBlocked);
        judge.stop(100.0, StopReason::Other);
        assert_eq!((judge.stops(), judge.nuisance()), (2, 0));
        judge.stop(100.0, StopReason::PathBlocked);
        assert_eq!(judge.nuisance(), 1);
    }
}
