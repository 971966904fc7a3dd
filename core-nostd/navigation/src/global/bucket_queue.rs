//! A circular bucket queue (Dial 1969) in storage of fixed size.
//!
//! Each bucket is a chain of chunks; chunks come from one pool and go back to it. Full is a value.

use floorguard_types::number::exact_usize;

/// Buckets; a power of two.
pub(super) const BUCKETS: usize = 64;
/// Words of a chunk: the first tells where the newest entry of the chunk before is, the rest are entries.
const CHUNK: u32 = 32;
const NONE: u32 = u32::MAX;

/// Entries by bucket.
#[derive(Debug)]
pub(super) struct BucketQueue<'a> {
    pool: &'a mut [u32],
    /// Where the newest entry of each bucket is; [`NONE`] is before the first word of all, as the end of a full chunk is before
    /// the next.
    newest: [u32; BUCKETS],
    /// First words of chunks given back, each holding the next.
    free: u32,
    /// Words never used begin here.
    fresh: u32,
}

impl<'a> BucketQueue<'a> {
    /// A queue without entries. Words that 32 bits cannot number are not used.
    pub(super) fn new(pool: &'a mut [u32]) -> Self {
        let pool = pool.chunks_mut(exact_usize(NONE)).next().unwrap_or_default();
        Self { pool, newest: [NONE; BUCKETS], free: NONE, fresh: 0 }
    }

    /// Adds an entry; false: full, nothing was added.
    #[inline]
    pub(super) fn push(&mut self, bucket: u32, value: u32) -> bool {
        let Some(newest) = self.newest.get_mut(exact_usize(bucket) % BUCKETS) else { return false };
        let mut at = newest.wrapping_add(1);
        if at % CHUNK == 0 {
            let chunk = if self.free == NONE { self.fresh } else { self.free };
            let Some(link) = self.pool.get_mut(exact_usize(chunk)) else { return false };
            if self.free == NONE {
                self.fresh = self.fresh.saturating_add(CHUNK);
            } else {
                self.free = *link;
            }
            *link = *newest;
            *newest = chunk;
            at = chunk.wrapping_add(1);
        }
        let Some(slot) = self.pool.get_mut(exact_usize(at)) else { return false };
        *slot = value;
        *newest = at;
        true
    }

    /// Takes the newest entry of a bucket.
    #[inline]
    pub(super) fn pop(&mut self, bucket: u32) -> Option<u32> {
        let newest = self.newest.get_mut(exact_usize(bucket) % BUCKETS)?;
        let value = self.pool.get(exact_usize(*newest)).copied()?;
        let before = newest.wrapping_sub(1);
        *newest = before;
        if before % CHUNK == 0
            && let Some(link) = self.pool.get_mut(exact_usize(before))
        {
            *newest = core::mem::replace(link, self.free);
            self.free = before;
        }
        Some(value)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::vec;
    use std::vec::Vec;

    #[test]
    fn chunks_round_trip_and_are_reused() {
        let entries_a_chunk = CHUNK as usize - 1;
        let mut pool = vec![0; 40 * CHUNK as usize];
        let mut queue = BucketQueue::new(&mut pool);
        let mut expected = vec![Vec::new(); BUCKETS];
        let mut random = floorguard_types::random::Pcg32::new(1, 1);
        for value in 0..50_000_u32 {
            let bucket = random.below(8) * 8;
            let values = &mut expected[bucket as usize];
            if random.bernoulli(0.51) {
                if queue.push(bucket, value) {
                    values.push(value);
                } else {
                    assert!(expected.iter().map(Vec::len).sum::<usize>() > 30 * entries_a_chunk);
                }
            } else {
                assert_eq!(queue.pop(bucket), values.pop());
            }
        }
        for (bucket, mut values) in expected.into_iter().enumerate() {
            for _ in 0..=values.len() {
                assert_eq!(queue.pop(bucket as u32), values.pop());
            }
        }
    }
}
