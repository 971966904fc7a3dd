//! How far a drive is: plain data for panel, recording and report.

use std::collections::BTreeMap;
use std::sync::Arc;

use floorguard_host::executor::PriorityLock;
use floorguard_mapping::GridGeometry;
use floorguard_runtime::channel::Latest;
use floorguard_types::geometry::{Point2, Pose2};
use floorguard_types::time::Stamp;

use super::reasons::StandingReason;

/// What a drive is doing.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum NavigationPhase {
    /// The pose or the first plan is missing.
    #[default]
    Starting,
    /// It stands until somebody outside orders a goal.
    Waiting,
    /// On the way, standing or not.
    Driving,
    /// At the goal.
    Reached,
    /// Nothing that can be reached is unknown any more.
    Explored,
    /// A person is needed: it stands obstructed for too long.
    NeedsHelp,
    /// The goal cannot be reached on this map, whatever moves on it.
    Unreachable,
}

impl NavigationPhase {
    /// In a word or two.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Starting => "starting",
            Self::Waiting => "waiting",
            Self::Driving => "driving",
            Self::Reached => "reached",
            Self::Explored => "explored",
            Self::NeedsHelp => "needs help",
            Self::Unreachable => "unreachable",
        }
    }

    /// Nothing more comes of it by itself.
    #[must_use]
    pub const fn is_over(self) -> bool {
        self.has_ended() || matches!(self, Self::NeedsHelp)
    }

    /// The robot has no reason to move.
    #[must_use]
    pub const fn stands(self) -> bool {
        self.has_ended() || matches!(self, Self::Waiting)
    }

    /// The robot drives no more. One that needs help goes on trying.
    #[must_use]
    pub const fn has_ended(self) -> bool {
        matches!(self, Self::Reached | Self::Explored | Self::Unreachable)
    }
}

/// The costmap around the robot, as percent: 0 free, 100 an obstacle, −1 unknown.
#[derive(Clone, Debug, PartialEq)]
pub struct CostmapImage {
    /// Where the cells lie in the map frame.
    pub geometry: GridGeometry,
    /// Along x first.
    pub cells: Vec<i8>,
}

/// How far an exploration is.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ExplorationProgress {
    /// Floor that is known, square metres.
    pub known_m2: f32,
    /// Frontiers that a way leads to.
    pub frontiers: usize,
    /// Frontiers that were given up, or that no way leads to.
    pub left_out: usize,
    /// Goals so far.
    pub goals: u32,
}

/// How far a tour is.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct TourProgress {
    /// Places to look from.
    pub places: u32,
    /// Places that the robot stood at and looked from.
    pub seen_from: u32,
    /// Places that no way was found to.
    pub left_out: u32,
}

/// A drive at a moment.
#[derive(Clone, Debug, PartialEq)]
pub struct NavigationProgress {
    /// When, on the robot's clock.
    pub stamp: Stamp,
    /// What it is doing.
    pub phase: NavigationPhase,
    /// In one sentence.
    pub words: String,
    /// Somebody has paused it.
    pub is_paused: bool,
    /// Why it stands, if it stands.
    pub standing: Option<StandingReason>,
    /// Where the odometry frame lies in the map frame, as believed now.
    pub odometry_in_map: Pose2,
    /// Where the robot is believed to be, map frame.
    pub pose_in_map: Pose2,
    /// The pose explains what the scanner sees.
    pub is_trusted: bool,
    /// Number of the goal that somebody outside ordered; 0: none was.
    pub goal_number: u32,
    /// Where it shall be, map frame.
    pub goal_in_map: Pose2,
    /// What is left of the path, map frame.
    pub path: Vec<Point2>,
    /// Along it, metres; none without a path.
    pub left_m: Option<f32>,
    /// Driven so far, metres.
    pub distance_m: f32,
    /// Global plans so far.
    pub plans: u32,
    /// How often each measure of recovery was taken.
    pub measures: BTreeMap<&'static str, u32>,
    /// What is left to explore; none on a known map.
    pub exploration: Option<ExplorationProgress>,
    /// How many places of a tour are done; none for a single goal.
    pub tour: Option<TourProgress>,
    /// The costmap around the robot; the newest one that was made.
    pub costmap: Option<Arc<CostmapImage>>,
}

/// The newest progress.
pub type NavigationWatch<M> = Latest<M, Arc<NavigationProgress>>;

/// A progress, for all who watch it.
pub type SharedNavigationWatch = Arc<NavigationWatch<PriorityLock>>;
