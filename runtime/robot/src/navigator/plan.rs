//! The input of a drive to a goal.

use std::path::Path;

use anyhow::Context;
use floorguard_configuration::{NavigationConfiguration, NavigationPlanner};
use floorguard_mapping::{Grid, GridGeometry, Occupancy};
use floorguard_types::geometry::{Point2, Pose2};
use serde::{Deserialize, Serialize};

use crate::cleaner::MapRuns;
use crate::site::ros_map::{self, OccupancyMap};

/// Finest cells of a map that is explored, metres.
const EXPLORED_CELL_M: f32 = 0.05;
/// Its cells along a side at most: what the planners can hold.
const EXPLORED_CELLS_MAX: f32 = 1_000.0;
/// A frontier is looked at from about here, metres, and in about its direction: the scanner sees three quarters of a circle.
const VIEW_WITHIN_M: f32 = 0.5;
const VIEW_WITHIN_RAD: f32 = 1.2;

/// How to drive.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct NavigationSettings {
    /// The dynamic window as published instead of ours.
    pub uses_dwa: bool,
    /// Greatest speed requested, m/s.
    pub speed_mps: f32,
    /// Greatest turning rate requested, rad/s.
    pub turn_radps: f32,
    /// The goal counts as reached within, metres.
    pub within_m: f32,
    /// And within, radians.
    pub within_rad: f32,
    /// Obstructed for so long without coming nearer to the goal, the robot calls for help, seconds.
    pub help_after_s: f32,
    /// For tests of the judges: the robot takes no obstacle into its costmap.
    #[serde(default)]
    pub is_blind: bool,
}

impl From<&NavigationConfiguration> for NavigationSettings {
    fn from(read: &NavigationConfiguration) -> Self {
        Self {
            uses_dwa: read.planner == NavigationPlanner::Dwa,
            speed_mps: read.speed_mps,
            turn_radps: read.turn_radps,
            within_m: read.within_m,
            within_rad: read.within_rad,
            help_after_s: read.help_after_s,
            is_blind: false,
        }
    }
}

/// From where to where, map frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Journey {
    /// Where the robot is.
    pub start_in_map: Pose2,
    /// Where it shall be.
    pub goal_in_map: Pose2,
}

/// A drive to a goal.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct NavigationPlan {
    /// How to drive.
    pub settings: NavigationSettings,
    /// Where the robot begins: x, y in metres and heading in radians, map frame.
    pub start: [f32; 3],
    /// Where it shall be, likewise.
    pub goal: [f32; 3],
    /// Seed of all randomness.
    pub seed: u64,
    /// The map is empty: the robot makes one, and chooses its goals itself until nothing that it can reach is unknown.
    #[serde(default)]
    pub explores: bool,
    /// Places to look from after the goal, one after another, as the goal.
    #[serde(default)]
    pub tour: Vec<[f32; 3]>,
    /// Behind the goal the robot comes back to where it began, and stands exactly there.
    #[serde(default)]
    pub docks: bool,
    map: MapRuns,
}

impl NavigationPlan {
    /// On a map, from one pose to another.
    #[must_use]
    pub fn on_map(settings: NavigationSettings, journey: Journey, (map, seed): (&OccupancyMap, u64)) -> Self {
        let numbers = |pose: Pose2| [pose.x_m, pose.y_m, pose.heading_rad];
        let (start, goal) = (numbers(journey.start_in_map), numbers(journey.goal_in_map));
        Self {
            settings,
            start,
            goal,
            seed,
            explores: false,
            tour: Vec::new(),
            docks: false,
            map: MapRuns::of(map),
        }
    }

    /// The same, with places to look from after the goal.
    #[must_use]
    pub fn touring(self, places: &[Pose2]) -> Self {
        Self { tour: places.iter().map(|pose| [pose.x_m, pose.y_m, pose.heading_rad]).collect(), ..self }
    }

    /// The same, and back to where it began.
    #[must_use]
    pub fn docking(self) -> Self {
        Self { docks: true, ..self }
    }

    /// From a pose on over floor of which nothing is known, as far as a square of this side around it, metres.
    ///
    /// # Errors
    /// The side makes no map.
    pub fn exploring(
        settings: NavigationSettings,
        start_in_map: Pose2,
        (side_m, seed): (f32, u64),
    ) -> anyhow::Result<Self> {
        let cell_m = EXPLORED_CELL_M.max(side_m / EXPLORED_CELLS_MAX);
        let cells = u16::try_from((side_m / cell_m).ceil() as u32)?;
        let corner = Point2::new(start_in_map.x_m - 0.5 * side_m, start_in_map.y_m - 0.5 * side_m);
        let geometry = GridGeometry::new(cells, cells, cell_m, corner)
            .with_context(|| format!("a square of {side_m} m makes no map"))?;
        let map = Grid::new(geometry, vec![Occupancy::Unknown; geometry.cell_count()])?;
        let journey = Journey { start_in_map, goal_in_map: start_in_map };
        let settings =
            NavigationSettings { within_m: VIEW_WITHIN_M, within_rad: VIEW_WITHIN_RAD, ..settings };
        Ok(Self { explores: true, ..Self::on_map(settings, journey, (&map, seed)) })
    }

    /// Of a `[navigation]` in a robot.toml that lies in `folder`.
    ///
    /// # Errors
    /// No map is named, or it cannot be read.
    pub fn of_configuration(
        navigation: &NavigationConfiguration,
        folder: &Path,
        goal: Pose2,
    ) -> anyhow::Result<Self> {
        let file = navigation.map.as_ref().context("`map` is missing; write map = \"hall.yaml\"")?;
        let map = ros_map::load(&folder.join(file))?;
        let [x_m, y_m, heading_rad] = navigation.start;
        let journey = Journey { start_in_map: Pose2::new(x_m, y_m, heading_rad), goal_in_map: goal };
        Ok(Self::on_map(navigation.into(), journey, (&map, 1)))
    }

    /// Where the robot begins, map frame.
    #[must_use]
    pub fn start_pose(&self) -> Pose2 {
        let [x_m, y_m, heading_rad] = self.start;
        Pose2::new(x_m, y_m, heading_rad)
    }

    /// The goal and the places after it, map frame.
    #[must_use]
    pub fn places_in_map(&self) -> Vec<Pose2> {
        let rest = self.tour.iter().map(|[x_m, y_m, heading_rad]| Pose2::new(*x_m, *y_m, *heading_rad));
        std::iter::once(self.goal_pose()).chain(rest).collect()
    }

    /// Where it shall be, map frame.
    #[must_use]
    pub fn goal_pose(&self) -> Pose2 {
        let [x_m, y_m, heading_rad] = self.goal;
        Pose2::new(x_m, y_m, heading_rad)
    }

    /// The map.
    ///
    /// # Errors
    /// The runs do not make one.
    pub fn occupancy(&self) -> anyhow::Result<OccupancyMap> {
        self.map.map()
    }

    /// As one line of text, for recordings.
    ///
    /// # Errors
    /// A non-finite number.
    pub fn to_text(&self) -> anyhow::Result<String> {
        Ok(serde_json::to_string(self)?)
    }

    /// From such a line.
    ///
    /// # Errors
    /// It is no plan.
    pub fn from_text(text: &str) -> anyhow::Result<Self> {
        Ok(serde_json::from_str(text)?)
    }
}
