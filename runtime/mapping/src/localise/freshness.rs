//! Whether a scan is a new look at the world: later than the one before, and not the same picture again.

use crate::input::ScanRecord;
use crate::se2::Se2;

/// What a scan is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ScanAge {
    /// New.
    Fresh,
    /// New, after a time without scans.
    AfterGap,
    /// Not later than one that came before.
    NotLater,
    /// The same ranges again although the robot has moved, or for longer than noise allows.
    Frozen,
}

/// Longer than this between two scans and the place is in doubt, seconds.
const GAP_S: f64 = 1.0;
/// A robot that moved this far, metres and radians, must see something else...
const MOVED: (f64, f64) = (0.1, 0.1);
/// ... and without odometry, a scanner whose ranges do not even quiver for so long stands still itself, seconds.
const STILL_S: f64 = 1.0;

/// The last new picture.
#[derive(Default)]
pub struct Freshness {
    last_s: Option<f64>,
    /// Time, odometry and ranges of the first scan with the present ranges.
    seen: Option<(f64, Option<Se2>, Vec<f32>)>,
}

impl Freshness {
    /// Judges the next scan.
    pub fn judge(&mut self, record: &ScanRecord) -> ScanAge {
        let passed_s = self.last_s.map(|last_s| record.time_s - last_s);
        if passed_s.is_some_and(|passed_s| passed_s <= 0.0) {
            return ScanAge::NotLater;
        }
        self.last_s = Some(record.time_s);
        if let Some((time_s, odometry, ranges_m)) = &self.seen {
            let is_same =
                ranges_m.iter().map(|m| m.to_bits()).eq(record.ranges_m.iter().map(|m| m.to_bits()));
            if is_same && is_suspicious(record.time_s - time_s, *odometry, record.odometry) {
                return ScanAge::Frozen;
            }
            if is_same {
                return ScanAge::Fresh;
            }
        }
        self.seen = Some((record.time_s, record.odometry, record.ranges_m.clone()));
        if passed_s.is_some_and(|passed_s| passed_s > GAP_S) { ScanAge::AfterGap } else { ScanAge::Fresh }
    }
}

fn is_suspicious(since_s: f64, before: Option<Se2>, now: Option<Se2>) -> bool {
    match (before, now) {
        (Some(before), Some(now)) => {
            let moved = before.between(now);
            moved.length_m() > MOVED.0 || moved.heading_rad.abs() > MOVED.1
        }
        _ => since_s > STILL_S,
    }
}
