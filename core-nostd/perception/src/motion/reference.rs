//! The moment before: a sweep to compare with, old enough that a slow walker has left his voxels.
//!
//! From one sweep to the next a person at 0.5 m/s moves by half a voxel, which noise hides (book, Motion:
//! Reference). Several references take turns: the oldest is compared with while the others age.

use super::seen_through::SeenThrough;
use super::voxels::Voxels;
use floorguard_types::number::count_u64;
use floorguard_types::profile::{Entry, Profile, Size, Table, TableOf};
use floorguard_types::time::Stamp;

/// A reference is compared with from this age on, microseconds: what moves at 0.3 m/s has left more than a voxel.
const AGE_MIN_US: u64 = 480_000;

/// One sweep as voxels and as a range image.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Reference<P: Profile> {
    pub(super) voxels: Voxels<P::MotionVoxels>,
    pub(super) seen: SeenThrough,
    stamp: Option<Stamp>,
    /// Columns that were measured.
    columns: usize,
}

impl<P: Profile> Entry for Reference<P> {
    const BLANK: Self = Self { voxels: Voxels::NEW, seen: SeenThrough::new(), stamp: None, columns: 0 };
}

/// All references.
#[derive(Clone, Debug)]
pub(super) struct References<P: Profile> {
    all: TableOf<Reference<P>, P::MotionReferences>,
}

impl<P: Profile> References<P> {
    /// Time between two references.
    const STEP_US: u64 = AGE_MIN_US / (count_u64(P::MotionReferences::N) - 1);

    pub(super) const fn new() -> Self {
        const { assert!(P::MotionReferences::N >= 2) };
        Self { all: Entry::BLANK }
    }

    /// Forgets all.
    pub(super) fn clear(&mut self) {
        for reference in self.all.iter_mut() {
            reference.stamp = None;
        }
    }

    /// The one to compare with: the oldest.
    pub(super) fn oldest(&self) -> Option<&Reference<P>> {
        self.all.iter().filter(|reference| reference.stamp.is_some()).min_by_key(|reference| reference.stamp)
    }

    /// A place for this sweep of so many measured columns, emptied, if a new reference is due: the youngest has aged by
    /// a step, or it knows much less than this sweep. The oldest one is replaced.
    pub(super) fn renew(&mut self, now: Stamp, columns: usize) -> Option<&mut Reference<P>> {
        let aged = |stamp: Stamp| now.as_micros().saturating_sub(stamp.as_micros()) >= Self::STEP_US;
        let youngest = self.all.iter_mut().max_by_key(|reference| reference.stamp)?;
        let poor = youngest.columns.saturating_mul(20) < columns.saturating_mul(19);
        if youngest.stamp.is_some_and(|stamp| !aged(stamp)) && !poor {
            return None;
        }
        let place = if poor {
            self.all.iter_mut().max_by_key(|reference| reference.stamp)?
        } else {
            // `None` sorts first: places that were never used.
            self.all.iter_mut().min_by_key(|reference| reference.stamp)?
        };
        place.voxels.clear();
        place.stamp = Some(now);
        place.columns = columns;
        Some(place)
    }
}
