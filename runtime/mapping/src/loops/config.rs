//! What the recognition of places is set by.

/// Settings of the loop closing.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LoopConfig {
    /// Length of a stretch, metres.
    pub stretch_m: f64,
    /// Scans of a stretch at most.
    pub stretch_nodes: usize,
    /// Edge of a cell of the search, metres.
    pub cell_m: f32,
    /// Reach of a return in the searched field, metres.
    pub reach_m: f32,
    /// A step of the heading, radians.
    pub turn_step_rad: f32,
    /// Points of a stretch lie at least this far apart, metres.
    pub thin_m: f32,
    /// Points of a stretch that are searched in another one, at most; all of them judge what was found.
    pub searched_points: usize,
    /// Distance of stretches that can have seen the same, without any doubt about their places, metres.
    pub near_m: f64,
    /// Half the side of the search window without any doubt, metres.
    pub window_m: f64,
    /// Growth of the window with the path between both, metres a metre.
    pub drift_share: f64,
    /// Half the side of the window at most, metres.
    pub window_most_m: f64,
    /// A place lies at most this share of half the side from the middle of the window.
    pub inner_share: f64,
    /// Half the window of the heading, radians, and its growth a metre of path, and its most.
    pub turn_window_rad: [f64; 3],
    /// Score that a place needs, 0 to 1.
    pub score_least: f32,
    /// Share of that score that the search asks for, before the descent.
    pub searched_share: f32,
    /// The second best place must lose at least so many times what the best place loses.
    pub loss_ratio: f32,
    /// Share of the points, at most, that lie where the other stretch saw through.
    pub conflict_most: f64,
    /// Share of the points, at least, that lie where the other stretch saw something.
    pub overlap_least: f64,
    /// Stretches that a new one is compared with, at most.
    pub partners_most: usize,
    /// Path between stretches below which no loop is searched, metres.
    pub path_least_m: f64,
}

impl Default for LoopConfig {
    fn default() -> Self {
        Self {
            stretch_m: 4.0,
            stretch_nodes: 30,
            cell_m: 0.1,
            reach_m: 0.3,
            turn_step_rad: 0.02,
            thin_m: 0.15,
            searched_points: 150,
            near_m: 5.0,
            window_m: 0.5,
            drift_share: 0.04,
            window_most_m: 10.0,
            inner_share: 0.75,
            turn_window_rad: [0.1, 0.005, 0.6],
            score_least: 0.6,
            searched_share: 0.8,
            loss_ratio: 1.25,
            conflict_most: 0.12,
            overlap_least: 0.5,
            partners_most: 4,
            path_least_m: 10.0,
        }
    }
}
