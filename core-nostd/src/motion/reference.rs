//! The moment before: a sweep to compare with, old enough that a slow walker has left his voxels.
//!
//! From one sweep to the next a person at 0.5 m/s moves by half a voxel, which noise hides (algorithms H.6, option
//! `stride`). Two references take turns: one is compared with while the other ages.

use super::seen_through::SeenThrough;
use super::voxels::Voxels;
use crate::time::Stamp;

/// A reference is compared with from this age on, microseconds: 0.5 m/s leave two voxels.
const AGE_MIN_US: u64 = 380_000;

/// One sweep as voxels and as a range image.
#[derive(Clone, Debug)]
pub(super) struct Reference {
    pub(super) voxels: Voxels,
    pub(super) seen: SeenThrough,
    stamp: Option<Stamp>,
}

impl Reference {
    const fn new() -> Self {
        Self { voxels: Voxels::new(), seen: SeenThrough::new(), stamp: None }
    }
}

/// The two that take turns.
#[derive(Clone, Debug)]
pub(super) struct References {
    both: [Reference; 2],
    /// Index of the younger one.
    younger: usize,
}

impl References {
    pub(super) const fn new() -> Self {
        Self { both: [Reference::new(), Reference::new()], younger: 0 }
    }

    /// Forgets both.
    pub(super) fn clear(&mut self) {
        for reference in &mut self.both {
            reference.stamp = None;
        }
    }

    /// The one to compare with: the older; the younger while there is no other.
    pub(super) fn current(&self) -> Option<&Reference> {
        let [first, second] = &self.both;
        let (younger, older) = if self.younger == 0 { (first, second) } else { (second, first) };
        [older, younger].into_iter().find(|reference| reference.stamp.is_some())
    }

    /// A place for this sweep, emptied, if the younger reference has aged enough to take the older's turn.
    pub(super) fn renew(&mut self, now: Stamp) -> Option<&mut Reference> {
        let aged = |stamp: Stamp| now.as_micros().saturating_sub(stamp.as_micros()) >= AGE_MIN_US;
        let [first, second] = &mut self.both;
        let (younger, older) = if self.younger == 0 { (first, second) } else { (second, first) };
        if younger.stamp.is_some_and(|stamp| !aged(stamp)) {
            return None;
        }
        let place = if younger.stamp.is_none() {
            younger
        } else {
            self.younger = 1 - self.younger.min(1);
            older
        };
        place.voxels.clear();
        place.stamp = Some(now);
        Some(place)
    }
}
