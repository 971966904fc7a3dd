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
    /// A place is occupied from so many hits on, if passes are fewer than for free space.
    pub hits_min: u8,
}

impl Default for EvidenceRule {
    fn default() -> Self {
        Self { passes_min: 3, passes_per_hit: 0.5, hits_min: 6 }
    }
}

impl EvidenceRule {
    /// Reads a voxel.
    ///
    /// ```
    /// use floorguard_mapping::people_removal::{Evidence, EvidenceRule, Voxel};
    ///
    /// let rule = EvidenceRule::default();
    /// let read = |hits, passes| rule.read(Voxel { hits, passes, last_sweep: 1 });
    /// assert_eq!(read(2, 40), Evidence::Free);
    /// assert_eq!(read(90, 4), Evidence::Occupied);
    /// // Never measured is not free.
    /// assert_eq!(rule.read(Voxel::default()), Evidence::Unknown);
    /// ```
    #[inline]
    #[must_use]
    pub fn read(&self, voxel: Voxel) -> Evidence {
        let (passes, hits) = (f32::from(voxel.passes), f32::from(voxel.hits));
        if voxel.passes >= self.passes_min && passes >= self.passes_per_hit * hits {
            Evidence::Free
        } else if voxel.hits >= self.hits_min {
            Evidence::Occupied
        } else {
            Evidence::Unknown
        }
    }
}
