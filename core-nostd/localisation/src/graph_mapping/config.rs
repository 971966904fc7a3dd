//! What the mapping is set by. One set of values for all buildings.

use crate::scan_matching::DescentConfig;

/// Settings.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GraphMappingConfig {
    /// Nearer returns belong to the robot, metres.
    pub range_least_m: f32,
    /// Farther returns are not used, metres.
    pub range_most_m: f32,
    /// A scan is matched once the robot has gone this far, metres...
    pub travel_m: f32,
    /// ... or turned this far, radians.
    pub turn_rad: f32,
    /// It is kept once the robot has gone this far from the one kept last, metres...
    pub keep_m: f32,
    /// ... or turned this far, radians.
    pub keep_rad: f32,
    /// Path whose kept scans a new one is matched against, metres.
    pub recent_m: f32,
    /// A step of the heading in a search, radians.
    pub search_step_rad: f32,
    /// Loss of score at the rim of the window of the tracking.
    pub rim_penalty: f32,
    /// The descent.
    pub descent: DescentConfig,
    /// Path between two places below which no loop is searched, metres.
    pub loop_path_least_m: f32,
    /// Half the side of the window of a loop without any doubt, metres; its growth, metres a metre of path; and its most, metres.
    pub loop_window_m: [f32; 3],
    /// The same of the heading: radians, radians a metre, radians.
    pub loop_turn_rad: [f32; 3],
    /// A place lies at most this share of half the side from the middle of the window.
    pub loop_inner_share: f32,
    /// Mean value of the returns that a loop needs, 0 to 1.
    pub loop_score_least: f32,
    /// The second best place must lose at least so many times what the best place loses.
    pub loop_loss_ratio: f32,
    /// Share of the returns, at most, that lie where the other place was seen through.
    pub loop_conflict_most: f32,
    /// Squared deviations up to which a loop counts in full.
    pub loop_trusted: f32,
}

impl Default for GraphMappingConfig {
    fn default() -> Self {
        Self {
            range_least_m: 0.1,
            range_most_m: 12.0,
            travel_m: 0.2,
            turn_rad: 0.2,
            keep_m: 0.9,
            keep_rad: 0.6,
            recent_m: 5.0,
            search_step_rad: 0.015,
            rim_penalty: 0.1,
            descent: DescentConfig {
                reach_m: 0.3,
                return_deviation_m: 0.15,
                outlier_distance_m: 0.1,
                steps_max: 12,
                step_least: 5.0e-4,
            },
            loop_path_least_m: 10.0,
            loop_window_m: [0.5, 0.04, 4.0],
            loop_turn_rad: [0.1, 0.005, 0.4],
            loop_inner_share: 0.75,
            loop_score_least: 0.6,
            loop_loss_ratio: 1.25,
            loop_conflict_most: 0.15,
            loop_trusted: 5.0,
        }
    }
}
