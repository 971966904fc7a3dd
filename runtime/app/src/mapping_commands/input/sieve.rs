//! What a mapper must not see: scans that are late, twice or frozen, and odometry that jumps.

use floorguard_mapping_host::Se2;
use floorguard_mapping_host::input::ScanRecord;
use serde::Serialize;

/// A scanner that moved this far, metres or radians, sees something else, to the last digit of some range.
const FROZEN: (f64, f64) = (0.05, 0.05);
/// No robot that cleans is faster, m/s and rad/s...
const SPEED_MAX: (f64, f64) = (5.0, 10.0);
/// ... and uneven clocks add no more than this, metres and radians: odometry that says so was set anew.
const STEP_MAX: (f64, f64) = (0.5, 1.0);
/// The clock of a log may step back so far from scan to scan, seconds; the odometry of the scan tells where it belongs.
const STEP_BACK_S: f64 = 1.0;

/// What was left out or mended, and why.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
pub struct SieveCounters {
    /// Scans that were used.
    pub scans: u64,
    /// Scans that are too late or come twice.
    pub not_later: u64,
    /// Scans that were used although their time is a little before that of the scan before.
    pub uneven_times: u64,
    /// Scans equal to the last one while the robot moved.
    pub frozen: u64,
    /// Scans without any return.
    pub empty: u64,
    /// Scans without odometry.
    pub without_odometry: u64,
    /// Times at which odometry jumped; it goes on from where it was.
    pub odometry_jumps: u64,
}

/// Looks at scans one by one.
#[derive(Debug, Default)]
pub struct Sieve {
    pub counters: SieveCounters,
    last_time_s: Option<f64>,
    /// The last scan with its own content, and the odometry at it.
    last_content: Option<(Vec<f32>, Option<Se2>)>,
    /// Raw odometry of the scan before, and its time.
    last_odometry: Option<(f64, Se2)>,
    /// Undoes the jumps so far.
    mend: Se2,
}

impl Sieve {
    /// The scan as the mapper may see it; `None` if it may not.
    pub fn pass(&mut self, mut record: ScanRecord) -> Option<ScanRecord> {
        let later_s = self.last_time_s.map_or(f64::INFINITY, |last_s| record.time_s - last_s);
        if later_s <= 0.0 {
            if later_s == 0.0 || later_s < -STEP_BACK_S || record.odometry.is_none() {
                self.counters.not_later += 1;
                return None;
            }
            self.counters.uneven_times += 1;
        }
        self.last_time_s = Some(record.time_s);
        record.odometry = record.odometry.map(|raw| self.mended(record.time_s, raw));
        if !record.ranges_m.iter().any(|range| range.is_finite() && *range > 0.0) {
            self.counters.empty += 1;
            return None;
        }
        if self.is_frozen(&record) {
            self.counters.frozen += 1;
            return None;
        }
        self.counters.scans += 1;
        self.counters.without_odometry += u64::from(record.odometry.is_none());
        Some(record)
    }

    fn mended(&mut self, time_s: f64, raw: Se2) -> Se2 {
        if let Some((last_s, last)) = self.last_odometry {
            let passed_s = (time_s - last_s).max(0.0);
            let step = last.between(raw);
            let (distance_m, turn_rad) = (step.x_m.hypot(step.y_m), step.heading_rad.abs());
            if distance_m > STEP_MAX.0 + SPEED_MAX.0 * passed_s
                || turn_rad > STEP_MAX.1 + SPEED_MAX.1 * passed_s
            {
                self.counters.odometry_jumps += 1;
                self.mend = self.mend.compose(last).compose(raw.inverse());
            }
        }
        self.last_odometry = Some((time_s, raw));
        self.mend.compose(raw)
    }

    fn is_frozen(&mut self, record: &ScanRecord) -> bool {
        let same = |a: &[f32], b: &[f32]| {
            a.len() == b.len() && a.iter().zip(b).all(|(a, b)| a.to_bits() == b.to_bits())
        };
        if let Some((ranges_m, odometry)) = &self.last_content
            && same(ranges_m, &record.ranges_m)
        {
            let moved = odometry.zip(record.odometry).map(|(before, now)| before.between(now));
            return moved.is_some_and(|moved| {
                moved.x_m.hypot(moved.y_m) > FROZEN.0 || moved.heading_rad.abs() > FROZEN.1
            });
        }
        self.last_content = Some((record.ranges_m.clone(), record.odometry));
        false
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn record(time_s: f64, x_m: f64, range_m: f32) -> ScanRecord {
        ScanRecord {
            time_s,
            odometry: Some(Se2::new(x_m, 0.0, 0.0)),
            first_angle_rad: 0.0,
            step_rad: 0.1,
            ranges_m: vec![range_m, 2.0],
            ..ScanRecord::default()
        }
    }

    #[test]
    fn late_frozen_and_empty_scans_are_left_out() {
        let mut sieve = Sieve::default();
        assert!(sieve.pass(record(1.0, 0.0, 3.0)).is_some());
        assert!(sieve.pass(record(1.0, 0.1, 3.1)).is_none(), "not later");
        assert!(sieve.pass(record(1.1, 0.01, 3.0)).is_some(), "stands still");
        assert!(sieve.pass(record(1.2, 0.2, 3.0)).is_none(), "frozen");
        assert!(sieve.pass(record(1.3, 0.3, 3.2)).is_some());
        let empty = ScanRecord { ranges_m: vec![f32::INFINITY; 2], ..record(1.4, 0.3, 0.0) };
        assert!(sieve.pass(empty).is_none());
        let counters = sieve.counters;
        assert_eq!((counters.scans, counters.not_later, counters.frozen, counters.empty), (3, 1, 1, 1));
        assert!(sieve.pass(record(1.2, 0.28, 3.3)).is_some(), "an uneven clock");
        assert!(sieve.pass(record(0.1, 0.28, 3.4)).is_none(), "far too late");
    }

    #[test]
    fn odometry_goes_on_after_a_jump() {
        let mut sieve = Sieve::default();
        let x = |record: Option<ScanRecord>| record.and_then(|record| record.odometry).map(|pose| pose.x_m);
        assert_eq!(x(sieve.pass(record(1.0, 7.0, 3.0))), Some(7.0));
        assert_eq!(x(sieve.pass(record(1.1, 0.0, 3.1))), Some(7.0), "set anew");
        let on = x(sieve.pass(record(1.2, 0.1, 3.2))).unwrap();
        assert!((on - 7.1).abs() < 1e-9 && sieve.counters.odometry_jumps == 1);
    }
}
