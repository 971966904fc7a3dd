//! A sweep of a log.

use floorguard_mapping::lidar_odometry::{SweepReturn, SweepTimes};

/// All returns of one revolution.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct SweepRecord {
    /// When it ended, seconds on the clock of the log.
    pub end_s: f64,
    /// From its first return to its last, seconds.
    pub duration_s: f64,
    /// In the order of firing.
    pub returns: Vec<SweepReturn>,
    /// Calibrated reflectivity of each return; empty where the log has none.
    pub reflectivity: Vec<u8>,
}

/// Times of a sweep after the one that ended at `before_s`; `None` if it is not later, or has no duration.
#[must_use]
pub fn sweep_times(sweep: &SweepRecord, before_s: Option<f64>) -> Option<SweepTimes> {
    let since_last_s = before_s.map_or(sweep.duration_s, |before_s| sweep.end_s - before_s);
    let good = |seconds: f64| seconds.is_finite() && seconds > 0.0;
    (good(since_last_s) && good(sweep.duration_s))
        .then_some(SweepTimes { since_last_s, duration_s: sweep.duration_s })
}
