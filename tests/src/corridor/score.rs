//! Detections against the truth: equation 10 of Rath et al. 2020, and false alarms.

use floorguard_types::geometry::Point2;

use super::Moment;

/// A moving object this near to the walker is the walker, metres: half a body and half a sweep's travel.
const MATCH_M: f32 = 0.5;
/// One this near to where the walker was up to [`WAKE_S`] ago is a late report of him, no false alarm.
const WAKE_M: f32 = 0.7;
const WAKE_S: f64 = 0.5;

/// Counts over sweeps.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Score {
    /// Sweeps in which the walker was within the area.
    pub present: u32,
    /// Of them those in which a moving object was found where he was.
    pub found: u32,
    /// Moving objects elsewhere, summed over the sweeps.
    pub false_positives: u32,
    /// Sweeps.
    pub sweeps: u32,
}

impl Score {
    /// Found of present, percent.
    #[must_use]
    pub fn accuracy(&self) -> f64 {
        100.0 * f64::from(self.found) / f64::from(self.present.max(1))
    }

    /// Enters a sweep: what was called moving, in the frame of the world, and the truth up to now.
    pub fn enter(&mut self, moving: &[Point2], truth: &[Moment], is_present: bool) {
        self.sweeps += 1;
        let Some(now) = truth.last() else { return };
        if is_present {
            self.present += 1;
            self.found += u32::from(moving.iter().any(|object| object.distance(now.walker) <= MATCH_M));
        }
        let recent = |moment: &&Moment| now.time_s - moment.time_s <= WAKE_S;
        let is_false = |object: &&Point2| {
            !truth.iter().rev().take_while(recent).any(|moment| moment.walker.distance(**object) <= WAKE_M)
        };
        self.false_positives += moving.iter().filter(is_false).count() as u32;
    }

    /// Adds another run.
    pub fn add(&mut self, other: &Self) {
        self.present += other.present;
        self.found += other.found;
        self.false_positives += other.false_positives;
        self.sweeps += other.sweeps;
    }
}
