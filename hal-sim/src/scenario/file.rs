//! The scenario file.

use floorguard_types::geometry::{Point2, Pose2};
use floorguard_types::random::Pcg32;
use serde::{Deserialize, Serialize};
use thiserror::Error;

use crate::dirt::{DirtFile, DirtyPatch};
use crate::people::{Bodies, Build, Person, PersonKind, RecordedWalk};
use crate::scene::{Scene, SceneFile};

/// Dirt lies at least this far from what stands on the floor, metres: half the diagonal of a patch.
const BESIDE_M: f32 = 0.071;

/// Why a scenario cannot be played.
#[derive(Debug, Error)]
pub enum ScenarioError {
    /// No built-in scenario of that name.
    #[error("no scenario is called `{0}`; there are: {1}")]
    Unknown(String, String),
    /// The text is not a scenario.
    #[error("the scenario is wrong: {0}")]
    Text(#[from] toml::de::Error),
}

/// Where the robot begins.
#[derive(Clone, Copy, Debug, Default, Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
pub struct StartFile {
    /// World frame, metres.
    pub at_m: [f32; 2],
    /// Counter-clockwise, degrees.
    #[serde(default)]
    pub yaw_deg: f32,
}

/// Where the robot is sent; waypoints in the world frame.
#[derive(Clone, Debug, Default, Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
pub struct RouteFile {
    /// m/s.
    pub speed_mps: f32,
    /// Start over at the end.
    #[serde(default)]
    pub repeat: bool,
    /// Metres.
    pub waypoints_m: Vec<[f32; 2]>,
}

/// A person, or several of one kind.
#[derive(Clone, Debug, Default, Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
pub struct PersonFile {
    /// Who.
    #[serde(default)]
    pub kind: PersonKind,
    /// Start, metres.
    pub at_m: [f32; 2],
    /// m/s; 0 stands.
    #[serde(default)]
    pub speed_mps: f32,
    /// Where somebody who stands looks, counter-clockwise, degrees.
    #[serde(default)]
    pub yaw_deg: f32,
    /// Where to walk, over and over.
    #[serde(default)]
    pub goals_m: Vec<[f32; 2]>,
    /// Stands until then, seconds.
    #[serde(default)]
    pub starts_s: f32,
    /// Walks around the robot.
    #[serde(default = "yes")]
    pub sees_robot: bool,
    /// Whether this one differs from others of the kind.
    #[serde(default)]
    pub bodies: Bodies,
}

fn yes() -> bool {
    true
}

/// People who go where others have really gone.
#[derive(Clone, Debug, Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
pub struct RecordedFile {
    /// The recording, beside the scenario file.
    pub file: String,
    /// Where its origin lies in the world, metres.
    #[serde(default)]
    pub at_m: [f32; 2],
    /// How it is turned, counter-clockwise, degrees.
    #[serde(default)]
    pub yaw_deg: f32,
    /// The run begins at this moment of the recording, seconds.
    #[serde(default)]
    pub from_s: f32,
}

/// Somebody drives the robot by hand: a command that is held for some time.
#[derive(Clone, Copy, Debug, Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
pub struct ManoeuvreFile {
    /// How long, seconds.
    pub seconds: f32,
    /// Forward, m/s; negative in reverse.
    #[serde(default)]
    pub forward_mps: f32,
    /// Counter-clockwise, rad/s.
    #[serde(default)]
    pub turn_radps: f32,
}

/// By how much a sensor is not where the robot's file says.
#[derive(Clone, Copy, Debug, Default, Deserialize, Serialize)]
#[serde(deny_unknown_fields, default)]
pub struct MisplacedFile {
    /// Forward, metres.
    pub x_m: f32,
    /// Left, metres.
    pub y_m: f32,
    /// Up, metres.
    pub z_m: f32,
    /// Counter-clockwise, degrees.
    pub yaw_deg: f32,
}

/// Drives that turn faster than commanded.
#[derive(Clone, Copy, Debug, Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
pub struct RunawayFile {
    /// From then on, seconds.
    pub from_s: f32,
    /// So many times as fast.
    pub gain: f32,
    /// Their own feedback shows the commanded speed.
    #[serde(default)]
    pub is_hidden: bool,
}

/// A gyroscope that turns without the robot.
#[derive(Clone, Copy, Debug, Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
pub struct TurningGyroscopeFile {
    /// From then on, seconds.
    pub from_s: f32,
    /// So fast, rad/s, counter-clockwise.
    pub turn_radps: f32,
}

/// Everything that a run begins with.
#[derive(Clone, Debug, Default, Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
pub struct Scenario {
    /// One line for people.
    pub title: String,
    /// The robot's start.
    #[serde(default)]
    pub start: StartFile,
    /// The robot's path.
    #[serde(default)]
    pub route: RouteFile,
    /// Commands by hand instead of the route, one after the other.
    #[serde(default)]
    pub manoeuvre: Vec<ManoeuvreFile>,
    /// The bumpers feel what the body runs into; otherwise they are never pressed.
    #[serde(default)]
    pub bumpers: bool,
    /// The bumpers are there and are never pressed, as with a cut strip that still says that all is well.
    #[serde(default)]
    pub deaf_bumpers: bool,
    /// The switches that feel for the floor never open.
    #[serde(default)]
    pub without_floor_switches: bool,
    /// Share of the floor's grip that is left: 1 dry, 0.3 wet soap; none: dry.
    pub grip: Option<f32>,
    /// Its drives turn faster than commanded.
    pub runaway: Option<RunawayFile>,
    /// Each wheel's encoder counts so much of what the wheel rolls: left and right, or all four; none: all of it.
    #[serde(default)]
    pub encoder_gains: Vec<f32>,
    /// The gyroscope turns without the robot.
    pub turning_gyroscope: Option<TurningGyroscopeFile>,
    /// The lidar is not where the robot's file says.
    pub lidar_misplaced: Option<MisplacedFile>,
    /// The scanner is not where the robot's file says.
    pub scanner_misplaced: Option<MisplacedFile>,
    /// What stands still.
    #[serde(default)]
    pub scene: SceneFile,
    /// Who is there.
    #[serde(default)]
    pub person: Vec<PersonFile>,
    /// People take detours around obstacles and walk round a robot in time, as people do. Without it they walk as
    /// social forces push them, up to the robot and into each other: the harder trial for its guard.
    #[serde(default)]
    pub attentive: bool,
    /// Adds 1 to 10 people whose straight paths cross the robot's at random.
    #[serde(default)]
    pub random_encounter: bool,
    /// A recording of people; the loader reads it into `walks`.
    pub recorded: Option<RecordedFile>,
    /// Dirt on the floor.
    pub dirt: Option<DirtFile>,
    /// What the recording says, in the world frame.
    #[serde(skip)]
    pub walks: Vec<RecordedWalk>,
}

impl Scenario {
    /// A device of the robot does otherwise than commanded, or measures otherwise than it is.
    #[must_use]
    pub const fn has_broken_devices(&self) -> bool {
        self.runaway.is_some() || self.turning_gyroscope.is_some() || !self.encoder_gains.is_empty()
    }

    /// Reads a scenario file.
    ///
    /// # Errors
    /// The text is not a scenario; the message names line and key.
    pub fn from_toml(text: &str) -> Result<Self, ScenarioError> {
        Ok(toml::from_str(text)?)
    }

    /// The text of a scenario file that says the same; what it refers to in other files is left to them.
    #[must_use]
    pub fn to_toml(&self) -> String {
        toml::to_string(self).unwrap_or_else(|error| format!("# cannot be written: {error}\n"))
    }

    /// The robot's start, world frame.
    #[must_use]
    pub fn start_pose(&self) -> Pose2 {
        Pose2::new(self.start.at_m[0], self.start.at_m[1], self.start.yaw_deg.to_radians())
    }

    /// The dirt of a run, patch by patch; none lies under what stands on the floor.
    #[must_use]
    pub fn dirt_patches(&self, scene: &Scene, seed: u64) -> Vec<DirtyPatch> {
        let is_floor = |place| scene.nearest_obstacle(place).is_none_or(|(_, gap_m)| gap_m > BESIDE_M);
        self.dirt.as_ref().map_or_else(Vec::new, |dirt| dirt.patches(seed, is_floor))
    }

    /// The people of a run.
    #[must_use]
    pub fn people(&self, seed: u64) -> Vec<Person> {
        let mut random = Pcg32::new(seed, 21);
        let files = self.person.iter().enumerate();
        let mut people: Vec<Person> =
            files.map(|(index, file)| person((seed, index), file, &mut random)).collect();
        if self.random_encounter {
            super::encounter::add_people(self.start_pose(), &mut people, &mut random);
        }
        for walk in &self.walks {
            people.push(Person { walk: Some(walk.clone()), ..random_person(people.len(), &mut random) });
        }
        people
    }
}

/// First of the streams from which bodies are drawn.
const BUILDS: u64 = 6_000;

/// Of a recording only the path is known.
fn random_person(index: usize, random: &mut Pcg32) -> Person {
    let adult = PersonFile {
        at_m: [0.0; 2],
        kind: PersonKind::Adult,
        speed_mps: 0.0,
        yaw_deg: 0.0,
        goals_m: Vec::new(),
        starts_s: 0.0,
        sees_robot: false,
        bodies: Bodies::Same,
    };
    person((0, index), &adult, random)
}

fn person((seed, index): (u64, usize), file: &PersonFile, random: &mut Pcg32) -> Person {
    let goals: Vec<Point2> = file.goals_m.iter().map(|[x, y]| Point2::new(*x, *y)).collect();
    let position = Point2::new(file.at_m[0], file.at_m[1]);
    let heading_rad = goals.first().map_or(file.yaw_deg.to_radians(), |goal| {
        libm::atan2f(goal.y_m - position.y_m, goal.x_m - position.x_m)
    });
    Person {
        id: index as u32 + 1,
        kind: file.kind,
        build: match file.bodies {
            Bodies::Same => Build::SAME,
            // Of its own seed: the paths stay the same.
            Bodies::Varied => Build::drawn(file.kind, &mut Pcg32::new(seed, BUILDS + index as u64)),
        },
        position,
        velocity: Point2::default(),
        heading_rad,
        gait_rad: random.uniform_between(0.0, core::f32::consts::TAU),
        goals,
        goal: 0,
        // Nobody walks exactly as planned: ±10 %.
        speed_mps: file.speed_mps * random.uniform_between(0.9, 1.1),
        starts_us: (f64::from(file.starts_s) * 1.0e6) as u64,
        sees_robot: file.sees_robot,
        walk: None,
    }
}
