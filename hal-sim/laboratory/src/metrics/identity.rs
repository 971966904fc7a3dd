//! Identity measures: which track belongs to whom over the whole run (Ristani et al., ECCV workshops 2016).

use std::collections::BTreeMap;

use super::assignment::best_pairs;

/// Frames in which a true object and a track were close enough to be the same.
#[derive(Clone, Debug, Default)]
pub(super) struct Overlaps {
    frames: BTreeMap<(u64, u64), i64>,
}

impl Overlaps {
    pub(super) fn add(&mut self, truth: u64, track: u64) {
        *self.frames.entry((truth, track)).or_insert(0) += 1;
    }

    /// Most observations that a one-to-one pairing of objects and tracks can explain (IDTP).
    pub(super) fn identity_true_positives(&self) -> u64 {
        let mut truths: Vec<_> = self.frames.keys().map(|(truth, _)| *truth).collect();
        let mut tracks: Vec<_> = self.frames.keys().map(|(_, track)| *track).collect();
        for ids in [&mut truths, &mut tracks] {
            ids.sort_unstable();
            ids.dedup();
        }
        let count = |row: usize, column: usize| -> i64 {
            self.frames.get(&(truths[row], tracks[column])).copied().unwrap_or(0)
        };
        let pairs = best_pairs(truths.len(), tracks.len(), count);
        pairs.into_iter().map(|(row, column)| count(row, column).unsigned_abs()).sum()
    }
}
