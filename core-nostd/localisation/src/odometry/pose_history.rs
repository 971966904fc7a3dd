//! Where the robot was when something was measured (128 poses, linear between them; book, Odometry: Pose history).

use floorguard_types::capacities::POSE_HISTORY;
use floorguard_types::geometry::{Pose2, wrap_angle};
use floorguard_types::number::nearest_f32;
use floorguard_types::time::{Age, Stamp};

/// Beyond the newest pose the motion is continued at most this far, microseconds (book, Odometry: Pose history).
const EXTRAPOLATION_MAX_US: u64 = 50_000;
/// Neighbouring poses farther apart in time than this are a gap, not a motion, microseconds.
const GAP_MAX_US: u64 = 200_000;

/// Why a pose is not known.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum PoseLookupError {
    /// Nothing was recorded yet.
    Empty,
    /// Older than the history.
    TooOld,
    /// Farther in the future than the motion may be continued.
    TooNew,
    /// The recording has a hole there.
    Gap,
}

/// A ring of stamped poses.
///
/// ```
/// use floorguard_localisation::odometry::{PoseHistory, PoseLookupError};
/// use floorguard_types::{geometry::Pose2, time::Stamp};
///
/// let mut history = PoseHistory::new();
/// for step in 0..10_u8 {
///     let stamp = Stamp::from_micros(u64::from(step) * 10_000);
///     history.record(stamp, Pose2::new(0.1 * f32::from(step), 0.0, 0.0));
/// }
/// let between = history.at(Stamp::from_micros(45_000)).unwrap();
/// assert!((between.x_m - 0.45).abs() < 1.0e-6);
/// assert_eq!(history.at(Stamp::from_micros(500_000)), Err(PoseLookupError::TooNew));
/// ```
#[derive(Clone, Debug)]
pub struct PoseHistory {
    entries: [(Stamp, Pose2); POSE_HISTORY],
    /// Where the next entry goes.
    next: usize,
    count: usize,
}

impl PoseHistory {
    /// Nothing recorded.
    #[must_use]
    pub const fn new() -> Self {
        let origin = Pose2 { x_m: 0.0, y_m: 0.0, heading_rad: 0.0 };
        Self { entries: [(Stamp::ZERO, origin); POSE_HISTORY], next: 0, count: 0 }
    }

    /// Appends a pose. One that is not newer than the newest is ignored.
    pub fn record(&mut self, stamp: Stamp, pose: Pose2) {
        if self.newest().is_some_and(|(newest, _)| stamp <= newest) {
            return;
        }
        if let Some(slot) = self.entries.get_mut(self.next) {
            *slot = (stamp, pose);
        }
        self.next = self.next.saturating_add(1) % POSE_HISTORY;
        self.count = self.count.saturating_add(1).min(POSE_HISTORY);
        debug_assert!(self.back(1).is_none_or(|(before, _)| before < stamp), "stamps ascend");
    }

    /// The newest entry.
    #[must_use]
    pub fn newest(&self) -> Option<(Stamp, Pose2)> {
        self.back(0)
    }

    /// The entry `steps` before the newest.
    fn back(&self, steps: usize) -> Option<(Stamp, Pose2)> {
        if steps >= self.count {
            return None;
        }
        let index = self.next.saturating_add(POSE_HISTORY).saturating_sub(steps).saturating_sub(1);
        self.entries.get(index % POSE_HISTORY).copied()
    }

    /// The pose at a moment: between two entries in a straight line, after the newest in continuation of the last
    /// step. Searches back from the newest entry, because almost every question is about the last 100 ms.
    ///
    /// # Errors
    /// [`PoseLookupError`]: the caller must not use a guess.
    pub fn at(&self, stamp: Stamp) -> Result<Pose2, PoseLookupError> {
        let newest = self.newest().ok_or(PoseLookupError::Empty)?;
        if let Age::Past(ahead_us) = newest.0.age(stamp) {
            return self.continued(newest, stamp, ahead_us);
        }
        let mut later = newest;
        for steps in 1..POSE_HISTORY {
            let earlier = self.back(steps).ok_or(PoseLookupError::TooOld)?;
            if earlier.0 <= stamp {
                return between(earlier, later, stamp);
            }
            later = earlier;
        }
        Err(PoseLookupError::TooOld)
    }

    fn continued(
        &self,
        newest: (Stamp, Pose2),
        stamp: Stamp,
        ahead_us: u64,
    ) -> Result<Pose2, PoseLookupError> {
        if ahead_us > EXTRAPOLATION_MAX_US {
            return Err(PoseLookupError::TooNew);
        }
        match self.back(1) {
            Some(before) if ahead_us > 0 => between(before, newest, stamp),
            _ => Ok(newest.1),
        }
    }
}

impl Default for PoseHistory {
    fn default() -> Self {
        Self::new()
    }
}

fn between(
    (from, a): (Stamp, Pose2),
    (to, b): (Stamp, Pose2),
    stamp: Stamp,
) -> Result<Pose2, PoseLookupError> {
    let step_s = to.seconds_since(from);
    if step_s > nearest_f32(GAP_MAX_US) * 1.0e-6 {
        return Err(PoseLookupError::Gap);
    }
    let share = if step_s > 0.0 { stamp.seconds_since(from) / step_s } else { 1.0 };
    Ok(Pose2::new(
        a.x_m + share * (b.x_m - a.x_m),
        a.y_m + share * (b.y_m - a.y_m),
        a.heading_rad + share * wrap_angle(b.heading_rad - a.heading_rad),
    ))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn history(count: u64) -> PoseHistory {
        let mut history = PoseHistory::new();
        for step in 0..count {
            let heading = 3.0 + 0.01 * step as f32;
            history.record(Stamp::from_micros(step * 10_000), Pose2::new(0.1 * step as f32, 0.0, heading));
        }
        history
    }

    #[test]
    fn interpolates_between_entries_and_across_heading_wrap() {
        let pose = history(100).at(Stamp::from_micros(145_000)).unwrap();
        assert!((pose.x_m - 1.45).abs() < 1e-5);
        assert!((pose.heading_rad - wrap_angle(3.145)).abs() < 1e-5, "{pose:?}");
    }

    #[test]
    fn continues_for_fifty_milliseconds_and_not_longer() {
        let history = history(300);
        let pose = history.at(Stamp::from_micros(2_990_000 + 50_000)).unwrap();
        assert!((pose.x_m - 30.4).abs() < 1e-4, "{pose:?}");
        assert_eq!(history.at(Stamp::from_micros(2_990_000 + 50_001)), Err(PoseLookupError::TooNew));
    }

    #[test]
    fn forgets_what_is_older_than_its_size() {
        let history = history(300);
        assert!(history.at(Stamp::from_micros((300 - 128) * 10_000)).is_ok());
        assert_eq!(history.at(Stamp::from_micros((300 - 129) * 10_000)), Err(PoseLookupError::TooOld));
        assert_eq!(PoseHistory::new().at(Stamp::ZERO), Err(PoseLookupError::Empty));
    }

    #[test]
    fn a_hole_is_not_bridged() {
        let mut history = history(10);
        history.record(Stamp::from_micros(500_000), Pose2::default());
        assert_eq!(history.at(Stamp::from_micros(300_000)), Err(PoseLookupError::Gap));
    }
}
