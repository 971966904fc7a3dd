//! What the closing of loops in space is set by.

use crate::loops::LoopConfig;
use crate::pose_graph::RobustConfig;

/// Settings.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SpaceCloserConfig {
    /// The search on the plane.
    pub search: LoopConfig,
    /// The optimisation.
    pub robust: RobustConfig,
    /// Returns within this angle of the horizontal are the scan of the search, radians.
    pub elevation_rad: f32,
    /// Share of the returns of a stretch that must lie on planes of the other, 0 to 1.
    pub share_least: f64,
    /// Root of the mean squared distance from the planes, at most, metres.
    pub misfit_most_m: f64,
    /// The measurement in space may be off from the search by this much on the plane, metres.
    pub away_most_m: f64,
    /// Variance of the odometry for each metre: of each rotation, rad²...
    pub turn_variance_per_m: f64,
    /// ... and of each direction, m².
    pub place_variance_per_m: f64,
}

impl Default for SpaceCloserConfig {
    fn default() -> Self {
        Self {
            search: LoopConfig::default(),
            robust: RobustConfig::default(),
            elevation_rad: 0.03,
            share_least: 0.5,
            misfit_most_m: 0.06,
            away_most_m: 0.5,
            turn_variance_per_m: 1.0e-6,
            place_variance_per_m: 2.5e-5,
        }
    }
}
