//! What the tracking of scans is set by. One set of values for all buildings and scanners.

use floorguard_localisation::scan_matching::DescentConfig;

/// Settings of the tracking.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FrontEndConfig {
    /// Nearer returns belong to the robot, metres.
    pub range_least_m: f32,
    /// Farther returns are not matched, metres.
    pub range_most_m: f32,
    /// A scan is matched once the robot has gone this far, metres.
    pub travel_m: f64,
    /// Or turned this far, radians.
    pub turn_rad: f64,
    /// Edge of a cell of the matched field, metres.
    pub cell_m: f32,
    /// Half the side of a local map, metres.
    pub half_side_m: f32,
    /// Distance from the start of one local map to the start of the next, metres; each serves twice as long.
    pub map_travel_m: f64,
    /// The same in scans.
    pub map_nodes: usize,
    /// A step of the heading in the search, radians.
    pub search_step_rad: f32,
    /// Loss of score at the rim of the search window.
    pub rim_penalty: f32,
    /// The descent.
    pub descent: DescentConfig,
}

impl Default for FrontEndConfig {
    fn default() -> Self {
        Self {
            range_least_m: 0.1,
            range_most_m: 30.0,
            travel_m: 0.2,
            turn_rad: 0.2,
            cell_m: 0.05,
            half_side_m: 42.0,
            map_travel_m: 5.0,
            map_nodes: 30,
            search_step_rad: 0.01,
            rim_penalty: 0.1,
            descent: DescentConfig {
                reach_m: 0.25,
                return_deviation_m: 0.15,
                outlier_distance_m: 0.1,
                steps_max: 15,
                step_least: 2.0e-4,
            },
        }
    }
}
