//! What a mission came to.

use floorguard_cleaning::Verdict;
use floorguard_types::geometry::Point2;

/// What a mission came to.
#[derive(Clone, Debug, Default)]
pub struct TrialResult {
    /// 99 % quantile of the dirt left over the cells that were dirty at the start (criterion b; book, Cleaning:
    /// Published protocol).
    pub quantile99: u32,
    /// The same over all reachable cells (criterion a).
    pub quantile99_all: u32,
    /// Most dirt left in a reachable cell (criterion c).
    pub max_left: u32,
    /// The quantile over the dirty cells is at most τ.
    pub success: bool,
    /// Distance driven, metres.
    pub distance_m: f32,
    /// Simulated time, s.
    pub time_s: f32,
    /// Part of it spent waiting for people, s.
    pub waited_s: f32,
    /// Re-plannings that changed the path.
    pub replannings: u32,
    /// Cells that were dirty at the start and can be reached.
    pub dirty_cells: u32,
    /// Of those, claimed to be clean at the end.
    pub claimed_cells: u32,
    /// Of those, in truth dirtier than tolerated.
    pub falsely_claimed_cells: u32,
    /// Dirty at the start, in truth clean at the end.
    pub truly_clean_cells: u32,
    /// Of those, claimed.
    pub truly_clean_claimed_cells: u32,
    /// All reachable cells that are claimed, dirty at the start or not.
    pub claimed_all_cells: u32,
    /// Reachable cells that are not claimed because too many of the possible paths missed them.
    pub uncertain_cells: u32,
    /// Reachable cells that are not claimed because they were visited in vain too often, or no pass was found.
    pub given_up_cells: u32,
    /// Dirty cells that cannot be reached: not guaranteed.
    pub unreachable_cells: u32,
    /// The mission came to its end, and every cell that it answers for is claimed.
    pub is_complete: bool,
    /// Mean error of the most likely particle, metres.
    pub mean_error_m: f32,
    /// Time in s and error of the most likely particle in metres, at every update.
    pub errors: Vec<(f32, f32)>,
    /// Times that the pose was found wrong.
    pub distrusts: u32,
    /// Faults that happened.
    pub faults: u32,
    /// Contacts with people while moving.
    pub avoidable_contacts: u32,
    /// Obstacles that stopped the robot.
    pub bumps: u32,
    /// Visits of cells.
    pub visits: u32,
    /// Mean time of an update, s of the computer.
    pub update_s: f64,
    /// First planning and slowest re-planning, s of the computer.
    pub planning_s: (f64, f64),
    /// The status of every cell at the end.
    pub verdicts: Vec<Option<Verdict>>,
    /// What really lies there.
    pub left: Vec<u32>,
    /// Share of the reachable cells over whose middle the brush really passed.
    pub covered_share: f32,
    /// Where the robot really was.
    pub path: Vec<Point2>,
    /// Units picked up, and where the robot believed to be.
    pub hits: Vec<(Point2, u32)>,
}

impl TrialResult {
    /// How far the robot was from where it believed to be at the last update, metres.
    #[must_use]
    pub fn off_at_end_m(&self) -> f32 {
        self.errors.last().map_or(0.0, |(_, off_m)| *off_m)
    }
}
