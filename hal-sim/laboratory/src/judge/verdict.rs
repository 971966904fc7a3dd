//! What a run comes to.

use floorguard_runtime::configuration::RobotConfiguration;
use floorguard_types::time::Stamp;
use serde::Serialize;

use super::contacts::ContactJudge;
use super::latency::Quantiles;
use super::stops::{StopJudge, StopReason};
use super::truth::Truth;
use crate::judge::MissionReport;
use floorguard_robot::learning::LearningReport;

/// The result of `floorguard simulate --json`.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Verdict {
    /// No avoidable contact, no missed stop, and the expectations of the scenario hold.
    pub passed: bool,
    /// Name of the scenario.
    pub scenario: String,
    /// Seed of all randomness.
    pub seed: u64,
    /// Simulated time, seconds.
    pub duration_s: f64,
    /// Seconds until the robot could move; none if it never could.
    pub ready_s: Option<f64>,
    /// Driven way, metres.
    pub distance_m: f64,
    /// Times that the robot and a person touched.
    pub contacts: u32,
    /// Those that braking would have prevented.
    pub avoidable_contacts: u32,
    /// Intrusions that the robot did not answer in time.
    pub missed_stops: u32,
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
    /// Sources that the records name as faulty.
    pub faulty_sources: Vec<String>,
    /// What was cleaned, if that was the mission.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub mission: Option<MissionReport>,
    /// What the robot learned of the looks of people, if it does.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub learned: Option<LearningReport>,
    /// Fingerprint of all outputs, 16 hexadecimal digits.
    pub digest: String,
}

/// All judges of a run.
pub struct Judge {
    contacts: ContactJudge,
    stops: StopJudge,
    last: Option<Stamp>,
    first: Option<Stamp>,
}

impl Judge {
    /// For a robot.
    #[must_use]
    pub fn new(robot: &RobotConfiguration) -> Self {
        Self { contacts: ContactJudge::new(robot), stops: StopJudge::new(robot), last: None, first: None }
    }

    /// Looks at the next moment. `commanded_mps` is what the drive was last told.
    pub fn observe(&mut self, truth: &Truth, commanded_mps: f32) {
        let step_s = self.last.map_or(0.0, |last| truth.stamp.seconds_since(last));
        self.first.get_or_insert(truth.stamp);
        self.last = Some(truth.stamp);
        self.contacts.observe(truth, step_s);
        self.stops.observe(truth, commanded_mps);
    }

    /// The robot decided to stop.
    pub fn stop(&mut self, at: Stamp, reason: StopReason) {
        self.stops.stop(at.as_micros() as f32 * 1.0e-6, reason);
    }

    /// The verdict so far; the caller adds names and tracking.
    #[must_use]
    pub fn verdict(&self) -> Verdict {
        let duration_s = self.last.zip(self.first).map_or(0.0, |(last, first)| last.seconds_since(first));
        Verdict {
            passed: self.contacts.avoidable() == 0 && self.stops.missed() == 0,
            duration_s: f64::from(duration_s),
            distance_m: f64::from(self.contacts.driven_m()),
            contacts: self.contacts.contacts(),
            avoidable_contacts: self.contacts.avoidable(),
            missed_stops: self.stops.missed(),
            nuisance_stops: self.stops.nuisance(),
            stops: self.stops.stops(),
            intrusion_latency_ms: Quantiles::of_micros(self.stops.latencies_us().to_vec()),
            ..Verdict::default()
        }
    }
}
