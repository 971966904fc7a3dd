//! What a mission has achieved so far: plain data for panel, recording and report.
//!
//! It is published over a slot that holds the newest one only, about once a second and shared by reference, so that a slow
//! reader costs the mission nothing.

use std::sync::Arc;

use floorguard_mapping::GridGeometry;
use floorguard_runtime::channel::Latest;
use floorguard_types::geometry::{Point2, Pose2};
use floorguard_types::time::Stamp;

use super::times::Times;

/// What a mission is doing.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum MissionPhase {
    /// The pose or the first plan is missing.
    #[default]
    Starting,
    /// Drives and cleans.
    Cleaning,
    /// The guard or a person holds the robot.
    Waiting,
    /// The operator has paused it.
    Paused,
    /// Nothing is left that could be cleaned.
    Done,
    /// The operator has given it up.
    Cancelled,
}

impl MissionPhase {
    /// In a word.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Starting => "starting",
            Self::Cleaning => "cleaning",
            Self::Waiting => "waiting",
            Self::Paused => "paused",
            Self::Done => "done",
            Self::Cancelled => "cancelled",
        }
    }

    /// Nothing more comes of it.
    #[must_use]
    pub const fn is_over(self) -> bool {
        matches!(self, Self::Done | Self::Cancelled)
    }
}

/// The status of a cell.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum CellState {
    /// No free floor, or the robot does not fit: the mission does not answer for it.
    #[default]
    OffLimits,
    /// Still to be cleaned.
    Dirty,
    /// Under the brush at this moment.
    Active,
    /// Swept, but not surely enough.
    Uncertain,
    /// Claimed to be clean with the confidence asked.
    Clean,
}

/// Why a cell is not claimed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Doubt {
    /// Not visited yet.
    NotVisited,
    /// Too many of the paths that the robot may have taken missed it.
    PathUnsure,
    /// Somebody or something stood there at every visit.
    Obstructed,
    /// Visited in vain too often.
    GivenUp,
}

impl Doubt {
    /// In plain words.
    #[must_use]
    pub const fn words(self) -> &'static str {
        match self {
            Self::NotVisited => "not visited yet",
            Self::PathUnsure => "the brush may have missed it",
            Self::Obstructed => "somebody or something stood there",
            Self::GivenUp => "visited in vain",
        }
    }
}

/// A cell that is not claimed, and why.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct UncertainCell {
    /// Index in the raster.
    pub cell: usize,
    /// Dirt that is still expected there, units.
    pub expected_units: f32,
    /// Why.
    pub doubt: Doubt,
}

/// Lanes of a mission that drives over the whole floor.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, serde::Serialize)]
pub struct LaneCount {
    /// That the floor needs.
    pub planned: u32,
    /// That were driven to their end; one that nobody could get to is left out.
    pub driven: u32,
}

/// A mission at a moment. Grids run along x first, from the corner `geometry.origin_in_map()`.
#[derive(Clone, Debug, PartialEq)]
pub struct MissionProgress {
    /// When, on the robot's clock.
    pub stamp: Stamp,
    /// What it is doing.
    pub phase: MissionPhase,
    /// Where the cells lie in the map frame.
    pub geometry: GridGeometry,
    /// Where the odometry frame lies in the map frame, as believed now.
    pub odometry_in_map: Pose2,
    /// Root of the mean squared error of the position that the belief expects, metres.
    pub position_deviation_m: f32,
    /// The status of each cell; [`CellState::Clean`] is the claimed-clean map.
    pub cells: Vec<CellState>,
    /// Dirt expected before the mission, units a cell.
    pub expected_before: Vec<f32>,
    /// Dirt expected now, units a cell.
    pub expected_now: Vec<f32>,
    /// Share of the cells that were dirty at the start and can be reached which is claimed clean, 0…1.
    pub completion: f32,
    /// Share of all cells that the mission answers for which is claimed clean, 0…1.
    pub claimed_fraction: f32,
    /// Cells that the mission answers for and does not claim.
    pub uncertain: Vec<UncertainCell>,
    /// Dirty cells that cannot be reached: never claimed.
    pub unreachable_cells: usize,
    /// Centres of the cells still to be visited, in the order of the visit, map frame.
    pub tour: Vec<Point2>,
    /// Where the robot drives next, map frame.
    pub waypoints: Vec<Point2>,
    /// Distance driven, metres.
    pub distance_m: f32,
    /// Time that people and what else held the robot cost, seconds.
    pub waited_s: f32,
    /// Where the time went.
    pub times: Times,
    /// Times that the path was planned anew around an obstacle or a person.
    pub detours: u32,
    /// Lanes, if it drives lanes: such a mission claims what it can prove, and guarantees nothing.
    pub lanes: Option<LaneCount>,
}

impl MissionProgress {
    /// In one line, for people.
    #[must_use]
    pub fn words(&self) -> String {
        let percent = 100.0 * self.completion;
        let name = self.phase.name();
        let (left, path_m) = (self.uncertain.len(), self.distance_m);
        format!(
            "{name}, {percent:.0} % of what was dirty is claimed clean, {left} cells are not yet, {path_m:.0} m driven"
        )
    }
}

/// The newest progress.
pub type MissionWatch<M> = Latest<M, Arc<MissionProgress>>;
