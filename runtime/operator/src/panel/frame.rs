//! One picture for the browsers.

use floorguard_types::geometry::Point2;
use floorguard_types::time::Stamp;
use serde::Serialize;

use super::headline::Headline;
use super::hub::Order;
use super::layers::MissionFrame;
use super::pieces::Piece;
use super::supplies::SuppliesFrame;
use crate::surroundings::Holder;
use floorguard_robot::cleaner::QueueStatus;

/// A place, metres, to the centimetre.
pub type Place = [f32; 2];

/// Rounds: a browser needs no micrometres.
pub fn place(point: Point2) -> Place {
    [round(point.x_m), round(point.y_m)]
}

/// To the hundredth.
pub fn round(value: f32) -> f32 {
    (value * 100.0).round() / 100.0
}

/// A track.
#[derive(Clone, Debug, Serialize)]
pub struct PersonFrame {
    /// Number.
    pub id: u32,
    /// In the odometry frame.
    pub at_m: Place,
    /// In the odometry frame.
    pub velocity_mps: Place,
    /// Taken for a person.
    pub person: bool,
}

/// A source.
#[derive(Clone, Debug, Serialize)]
pub struct SourceFrame {
    /// Name.
    pub name: &'static str,
    /// In one word.
    pub health: String,
    /// The guard accepts it.
    pub good: bool,
    /// Age of its newest measurement, ms; none before the first.
    pub age_ms: Option<u64>,
}

/// A cause, now or of an earlier stop.
#[derive(Clone, Debug, Serialize)]
pub struct CauseFrame {
    /// Robot time, seconds.
    pub at_s: f64,
    /// What happened, without numbers.
    pub name: String,
    /// What happened, in words and numbers.
    pub text: String,
    /// The same piece by piece, for other languages; empty where the name says it all.
    pub pieces: Vec<Piece>,
    /// What helps.
    pub remedy: &'static str,
}

/// Everything that a page shows.
#[derive(Clone, Debug, Default, Serialize)]
pub struct Frame {
    /// Counts pictures.
    pub number: u64,
    /// Robot time.
    #[serde(skip)]
    pub stamp: Stamp,
    /// Robot time since the page's zero, seconds.
    pub time_s: f64,
    /// What runs: scenario or configuration.
    pub title: String,
    /// What the robot does or waits for, in a few words.
    pub headline: String,
    /// The same as a sentence with a gap, for other languages.
    pub headline_parts: Headline,
    /// The person or obstacle that holds or slows it, in the robot's frame.
    pub holder: Option<Holder>,
    /// The guard's state.
    pub state: String,
    /// The most severe demand, in words.
    pub action: String,
    /// Speed now, m/s.
    pub speed_mps: f32,
    /// Greatest speed permitted now, m/s.
    pub limit_mps: f32,
    /// The operator has pressed pause.
    pub paused: bool,
    /// The guard waits for a reset.
    pub reset_allowed: bool,
    /// Why the last reset was refused, and what helps, while the guard waits for a reset.
    pub reset_refused: Option<String>,
    /// The same piece by piece, for other languages.
    pub reset_refused_pieces: Vec<Piece>,
    /// The guard waits for the start command.
    pub start_allowed: bool,
    /// Where the robot is in the odometry frame: x, y, heading.
    pub pose: [f32; 3],
    /// Metres driven since the start.
    pub driven_m: f32,
    /// Waypoints of the mission, and whether it begins again at the end.
    pub route: Vec<Place>,
    /// What a drive to a goal does, in one sentence; its path is the route then.
    pub drive: Option<String>,
    /// Outline of the robot, in its frame.
    pub footprint: Vec<Place>,
    /// The watched field, in the robot's frame.
    pub protective: Vec<Place>,
    /// The warning field, in the robot's frame.
    pub warning: Vec<Place>,
    /// What the safety scanner saw, in the robot's frame.
    pub scan: Vec<Place>,
    /// What the lidar saw above the floor, in the robot's frame.
    pub lidar: Vec<Place>,
    /// Tracks.
    pub people: Vec<PersonFrame>,
    /// Sources.
    pub sources: Vec<SourceFrame>,
    /// What limits or holds the robot now.
    pub cause: Option<CauseFrame>,
    /// What stopped it first, where that is something else.
    pub first_cause: Option<CauseFrame>,
    /// How far the cleaning mission is, if there is one.
    pub mission: Option<MissionFrame>,
    /// Missions that wait, and what came of the last order to them.
    pub queue: Option<QueueStatus>,
    /// Number of the newest records: areas, alerts, days, schedules and parts.
    pub records: u64,
    /// What the robot uses up, if it reports that.
    pub supplies: Option<SuppliesFrame>,
    /// Counts pictures of the camera; 0: there is none.
    pub camera: u64,
    /// How many other robots this page can show.
    pub robots: usize,
    /// The last stops, newest first.
    pub stops: Vec<CauseFrame>,
}

impl Frame {
    /// The operator's act that the guard waits for.
    #[must_use]
    pub const fn awaited(&self) -> Option<Order> {
        match (self.reset_allowed, self.start_allowed) {
            (true, _) => Some(Order::Reset),
            (false, true) => Some(Order::Start),
            (false, false) => None,
        }
    }
}
