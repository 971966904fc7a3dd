//! What a run comes to.

use std::collections::BTreeMap;

use floorguard_contact_judge::Report;
use floorguard_runtime::configuration::RobotConfiguration;
use floorguard_sim::robot::RobotParameters;
use floorguard_sim::simulation::Simulation;
use floorguard_types::time::Stamp;
use serde::Serialize;

use super::latency::Quantiles;
use super::outcome::Outcome;
use super::stops::{StopJudge, StopReason};
use super::true_world::TrueContacts;
use super::truth::Truth;
use crate::judge::{MissionReport, NavigationReport};
use floorguard_operator::panel::{HeldEvent, HeldKind};
use floorguard_robot::learning::LearningReport;

/// The result of `floorguard simulate --json`.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Verdict {
    /// What [`Report::passed`] says, and every intrusion into the robot's own protective field was answered in time.
    pub passed: bool,
    /// Why not.
    pub failures: Vec<String>,
    /// What the run comes to: good, failed, or not finished.
    pub verdict: Outcome,
    /// Why, in words.
    pub reason: String,
    /// Name of the scenario.
    pub scenario: String,
    /// Seed of all randomness.
    pub seed: u64,
    /// Simulated time, seconds.
    pub duration_s: f64,
    /// Seconds until the robot could move; none if it never could.
    pub ready_s: Option<f64>,
    /// Distance driven, metres.
    pub distance_m: f64,
    /// Times that any part of the robot touched anything, people who walked into the standing robot included.
    pub contacts: u32,
    /// Those that this machine's sensors could have avoided.
    pub avoidable_contacts: u32,
    /// Times that the body would have hit something that a sensor had seen.
    pub missed_stops: u32,
    /// Intrusions into the robot's own protective field that it did not answer in time.
    pub late_field_stops: u32,
    /// Stops for something that was not there.
    pub nuisance_stops: u32,
    /// All stops.
    pub stops: u32,
    /// From the measurement that made the robot stop to the order on the bus, milliseconds. A lidar
    /// revolution counts from its end, a lost source from its last good message, the emergency stop from its being
    /// pressed. Stops of a robot that stood need no order and do not count.
    pub stop_latency_ms: Quantiles,
    /// By ground truth: from the moment something was 5 cm deep in the protective zone of the true speed to the order, ms;
    /// most stops come earlier, by time to collision, and do not count.
    pub intrusion_latency_ms: Quantiles,
    /// Tracking accuracy (CLEAR MOT), up to 1; none when nobody was to be tracked.
    pub mota: Option<f64>,
    /// Identity F1 score, 0 to 1.
    pub idf1: Option<f64>,
    /// Times that a person's track changed its number.
    pub id_switches: u32,
    /// Mean distance between track and person, metres.
    pub localisation_error_m: Option<f64>,
    /// Times that the operator pressed reset.
    pub resets: u32,
    /// Robot time under each cause that limited or stopped, seconds.
    pub held_back_s: BTreeMap<String, f64>,
    /// What else held the robot than what began a stop, and what came of the resets.
    pub history: Vec<HeardOf>,
    /// Sources that the records name as faulty.
    pub faulty_sources: Vec<String>,
    /// What was cleaned, if that was the mission.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub mission: Option<MissionReport>,
    /// What the drive came to, if it had a goal.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub navigation: Option<NavigationReport>,
    /// What the robot learned of the appearance of people, if it does.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub learned: Option<LearningReport>,
    /// All that the judge of contacts has to say: every contact with its kind, place, speed and blame.
    pub bodies: Report,
    /// Fingerprint of all outputs, 16 hexadecimal digits.
    pub digest: String,
}

impl Verdict {
    /// Why the run does not pass, in one line.
    #[must_use]
    pub fn why_not(&self) -> String {
        let first = self.bodies.contacts.iter().find(|contact| contact.while_moving());
        let first = first.map(|contact| format!(" ({})", contact.line())).unwrap_or_default();
        format!("{}{first}", self.failures.join(", "))
    }

    /// Every kind of contact, in words.
    #[must_use]
    pub fn contacts_in_words(&self) -> String {
        let counts = &self.bodies.counts;
        format!(
            "{} while it moved ({} with people, {} with objects, {} over edges): {}",
            counts.while_moving(),
            counts.people_while_moving,
            counts.drove_into_things,
            counts.over_edges,
            counts.headline()
        )
    }
}

/// An entry of the history of a run, as the robot reported it.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct HeardOf {
    /// Seconds since the start.
    pub at_s: f64,
    /// What it tells of.
    pub kind: HeldKind,
    /// In one line.
    pub text: String,
    /// What helps; empty if there is nothing to do.
    pub remedy: &'static str,
}

impl HeardOf {
    /// Of an event at a moment of the world.
    #[must_use]
    pub fn of(at: Stamp, event: &HeldEvent) -> Self {
        let at_s = at.as_micros() as f64 * 1.0e-6;
        Self { at_s, kind: event.kind, text: event.line(), remedy: event.remedy }
    }
}

/// All judges of a run.
pub struct Judge {
    bodies: Option<TrueContacts>,
    stops: StopJudge,
}

impl Judge {
    /// For a robot, and what is fixed about the true one.
    #[must_use]
    pub fn new(robot: &RobotConfiguration, parameters: &RobotParameters) -> Self {
        Self { bodies: None, stops: StopJudge::new(robot, parameters) }
    }

    /// The world is there; without this nobody judges contacts, and no run passes.
    pub fn begin(&mut self, bodies: TrueContacts) {
        self.bodies = Some(bodies);
    }

    /// Processes the next sample. `commanded_mps` is the last command to the drive.
    pub fn observe(&mut self, simulation: &Simulation, (truth, commanded_mps): (&Truth, f32)) {
        if let Some(bodies) = &mut self.bodies {
            bodies.observe(simulation);
        }
        self.stops.observe(truth, commanded_mps);
    }

    /// The robot decided to stop.
    pub fn stop(&mut self, at: Stamp, reason: StopReason) {
        self.stops.stop(at.as_micros() as f32 * 1.0e-6, reason);
        if let Some(bodies) = self.bodies.as_mut().filter(|_| reason != StopReason::Other) {
            bodies.stop(at.as_micros() as f64 * 1.0e-6);
        }
    }

    /// The verdict so far; the caller adds names and tracking.
    #[must_use]
    pub fn verdict(&self, ready_s: Option<f64>) -> Verdict {
        let bodies = self.bodies.as_ref().map(|bodies| bodies.report(ready_s)).unwrap_or_default();
        let late_field_stops = self.stops.missed();
        let mut failures = bodies.failures.clone();
        if late_field_stops > 0 {
            failures.push(format!("{late_field_stops} late answers to its own protective field"));
        }
        Verdict {
            passed: bodies.passed && late_field_stops == 0,
            failures,
            duration_s: bodies.duration_s,
            distance_m: bodies.travelled_m,
            contacts: bodies.counts.while_moving() + bodies.counts.walked_into_standing,
            avoidable_contacts: bodies.counts.avoidable_by_sensors,
            missed_stops: bodies.missed_stops,
            late_field_stops,
            nuisance_stops: bodies.nuisance_stops,
            stops: self.stops.stops(),
            intrusion_latency_ms: Quantiles::of_micros(self.stops.latencies_us().to_vec()),
            ready_s,
            bodies,
            ..Verdict::default()
        }
    }
}
