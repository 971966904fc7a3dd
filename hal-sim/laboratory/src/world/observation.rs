//! What was seen of a simulated run: what its report shows.

use floorguard_robot::camera::SeenDirt;
use floorguard_robot::environment::PeopleSeen;
use floorguard_robot::learning::LearningReport;
use floorguard_robot::navigator::SurveyedMap;
use floorguard_types::geometry::{Point2, Pose2};

use crate::judge::{HeardOf, MissionOutcome, Verdict};

/// A path is drawn with one place per quarter of a second.
pub const PATH_US: u64 = 250_000;

/// A stop, for the report.
#[derive(Clone, Debug, PartialEq)]
pub struct SeenStop {
    /// Seconds since the start.
    pub at_s: f64,
    /// Where the robot really was.
    pub position: Point2,
    /// In words.
    pub cause: String,
    /// In a few words, without numbers.
    pub kind: String,
    /// Speed at that moment, m/s.
    pub speed_mps: f32,
}

/// The people in the guard's advice at one moment.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct AdvisedPeople {
    /// End of the sweep, the robot's clock, microseconds.
    pub at_us: u64,
    /// How many.
    pub count: usize,
}

/// What was seen of a run.
#[derive(Clone, Debug, Default)]
pub struct Observation {
    /// The verdict.
    pub verdict: Verdict,
    /// Where the robot was.
    pub robot_path: Vec<Pose2>,
    /// What came into the scene, by its index among the scenario's furniture.
    pub came: Vec<usize>,
    /// Where each person was, by the person's number.
    pub people_paths: std::collections::BTreeMap<u32, Vec<Point2>>,
    /// The robot's own list of people, five times a second.
    pub people_seen: Vec<PeopleSeen>,
    /// Of how many people the guard was advised, each time it was.
    pub advised: Vec<AdvisedPeople>,
    /// Every stop.
    pub stops: Vec<SeenStop>,
    /// What else held the robot than what began a stop, and what came of the resets.
    pub held: Vec<HeardOf>,
    /// Times that the operator pressed reset.
    pub resets: u32,
    /// Seconds from the start until the robot could move.
    pub ready_s: Option<f64>,
    /// Floor that the brush went over, m².
    pub cleaned_m2: f64,
    /// Robot time under each cause that limited or stopped, seconds.
    pub under_cause_s: std::collections::BTreeMap<String, f64>,
    /// Speed and limit, one pair per second: time, speed, limit.
    pub speeds: Vec<(f64, f32, f32)>,
    /// What was cleaned, if that was the mission.
    pub mission: Option<MissionOutcome>,
    /// What the floor camera saw of the dirt, if there was one; in the odometry frame.
    pub seen_dirt: Option<SeenDirt>,
    /// What the robot learned of the appearance of people, if it does.
    pub learned: Option<LearningReport>,
    /// The map that the robot made, if it explored.
    pub surveyed: Option<SurveyedMap>,
}

impl Observation {
    pub(super) fn note_advice(&mut self, at_us: u64, count: usize) {
        self.advised.push(AdvisedPeople { at_us, count });
    }

    /// The distance between two moments, seconds since the start, as far as the run went: metres along the noted
    /// places.
    #[must_use]
    pub fn path_m(&self, from_s: f64, to_s: f64) -> f32 {
        let index = |seconds: f64| (seconds * 1.0e6) as usize / PATH_US as usize;
        let places = self.robot_path.get(index(from_s)..index(to_s).min(self.robot_path.len()));
        let steps = places.unwrap_or_default().windows(2);
        steps.map(|pair| (pair[1].x_m - pair[0].x_m).hypot(pair[1].y_m - pair[0].y_m)).sum()
    }
}
