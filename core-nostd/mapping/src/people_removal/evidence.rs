//! What the counts of a voxel say about a point in it.

use super::voxels::Voxel;

/// What is known about the space of a point.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Evidence {
    /// Rays went through it often enough: what was there has moved.
    Free,
    /// Returns came from it in several sweeps, and hardly a ray went through.
    Occupied,
    /// Neither.
    Unknown,
}

/// How counts are read.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct EvidenceRule {
    /// At least so many sweeps went through ...
    pub passes_min: u8,
    /// ... and so many for each sweep that ended there.
    pub passes_per_hit: f32,
    /// Or so many sweeps went through between two hits, before the first or after the last ...
    pub run_min: u8,
    /// ... and so many for each hit: someone stood there for long, and left.
    pub run_passes_per_hit: f32,
    /// A place is occupied from so many hits on, if passes are fewer than for free space.
    pub hits_min: u8,
}

impl Default for EvidenceRule {
    fn default() -> Self {
        Self { passes_min: 3, passes_per_hit: 0.35, run_min: 20, run_passes_per_hit: 0.1, hits_min: 6 }
    }
}

impl EvidenceRule {
    /// Reads a voxel.
    ///
    /// ```
    /// use floorguard_mapping::people_removal::{Evidence, EvidenceRule, Voxel};
    ///
    /// let rule = EvidenceRule::default();
    /// let read = |hits, passes, longest_run| rule.read(Voxel { hits, passes, longest_run, ..Voxel::default() });
    /// assert_eq!(read(2, 40, 30), Evidence::Free);
    /// assert_eq!(read(90, 20, 2), Evidence::Occupied);
    /// // A person stood there for nine seconds, and left.
    /// assert_eq!(read(90, 30, 30), Evidence::Free);
    /// // Never measured is not free.
    /// assert_eq!(rule.read(Voxel::default()), Evidence::Unknown);
    /// ```
    #[inline]
    #[must_use]
    pub fn read(&self, voxel: Voxel) -> Evidence {
        let (passes, hits) = (f32::from(voxel.passes), f32::from(voxel.hits));
        let is_mostly_free = voxel.passes >= self.passes_min && passes >= self.passes_per_hit * hits;
        let was_left = voxel.longest_run >= self.run_min && passes >= self.run_passes_per_hit * hits;
        if is_mostly_free || was_left {
            Evidence::Free
        } else if voxel.hits >= self.hits_min {
            Evidence::Occupied
        } else {
            Evidence::Unknown
        }
    }
}
