//! A circular bucket queue (Dial 1969) in storage of fixed size.
//!
//! Each bucket is a chain of chunks; chunks come from one pool and go back to it. Full is a value.

use floorguard_types::number::exact_usize;

/// Buckets; a power of two.
pub(super) const BUCKETS: usize = 64;
/// Words of a chunk: one that points to the next chunk, the rest are entries.
const CHUNK: usize = 32;
const NONE: u32 = u32::MAX;

/// A bucket: its newest chunk, and how many entries that holds.
#[derive(Clone, Copy, Debug)]
struct Bucket {
    chunk: u32,
    entries: usize,
}

const EMPTY: Bucket = Bucket { chunk: NONE, entries: CHUNK - 1 };

/// Entries by bucket.
#[derive(Clone, Debug)]
pub(super) struct BucketQueue<Q> {
    pool: Q,
    buckets: [Bucket; BUCKETS],
    /// Chunks given back.
    free: u32,
    /// Chunks never used begin here.
    fresh: u32,
}

impl<Q: AsRef<[u32]> + AsMut<[u32]>> BucketQueue<Q> {
    pub(super) const fn new(pool: Q) -> Self {
        Self { pool, buckets: [EMPTY; BUCKETS], free: NONE, fresh: 0 }
    }

    pub(super) const fn clear(&mut self) {
        self.buckets = [EMPTY; BUCKETS];
        self.free = NONE;
        self.fresh = 0;
    }

    #[inline]
    const fn place(chunk: u32, entry: usize) -> usize {
        exact_usize(chunk).saturating_mul(CHUNK).saturating_add(entry)
    }

    /// Adds an entry; false: full, nothing was added.
    #[inline]
    pub(super) fn push(&mut self, bucket: usize, value: u32) -> bool {
        let Some(bucket) = self.buckets.get_mut(bucket % BUCKETS) else { return false };
        let pool = self.pool.as_mut();
        if bucket.entries >= CHUNK - 1 {
            let chunk = if self.free == NONE { self.fresh } else { self.free };
            let Some(next) = pool.get_mut(Self::place(chunk, 0)) else { return false };
            if self.free == NONE {
                self.fresh = self.fresh.saturating_add(1);
            } else {
                self.free = *next;
            }
            *next = bucket.chunk;
            *bucket = Bucket { chunk, entries: 0 };
        }
        let entry = bucket.entries.saturating_add(1);
        let Some(slot) = pool.get_mut(Self::place(bucket.chunk, entry)) else { return false };
        *slot = value;
        bucket.entries = entry;
        true
    }

    /// Takes the newest entry of a bucket.
    #[inline]
    pub(super) fn pop(&mut self, bucket: usize) -> Option<u32> {
        let bucket = self.buckets.get_mut(bucket % BUCKETS)?;
        if bucket.chunk == NONE {
            return None;
        }
        let pool = self.pool.as_mut();
        let value = pool.get(Self::place(bucket.chunk, bucket.entries)).copied();
        bucket.entries = bucket.entries.saturating_sub(1);
        if bucket.entries == 0 {
            let chunk = bucket.chunk;
            if let Some(next) = pool.get_mut(Self::place(chunk, 0)) {
                bucket.chunk = core::mem::replace(next, self.free);
                bucket.entries = CHUNK - 1;
                self.free = chunk;
            }
        }
        value
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::vec;
    use std::vec::Vec;

    #[test]
    fn chunks_round_trip_and_are_reused() {
        let mut queue = BucketQueue::new(vec![0; 40 * CHUNK]);
        let mut expected = vec![Vec::new(); BUCKETS];
        let mut random = floorguard_types::random::Pcg32::new(1, 1);
        for value in 0..50_000_u32 {
            let bucket = random.below(8) as usize * 8;
            if random.bernoulli(0.51) {
                if queue.push(bucket, value) {
                    expected[bucket].push(value);
                } else {
                    assert!(expected.iter().map(Vec::len).sum::<usize>() > 30 * (CHUNK - 1));
                }
            } else {
                assert_eq!(queue.pop(bucket), expected[bucket].pop());
            }
        }
        for (bucket, mut values) in expected.into_iter().enumerate() {
            for _ in 0..=values.len() {
                assert_eq!(queue.pop(bucket), values.pop());
            }
        }
    }
}
