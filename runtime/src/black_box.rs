//! The last ten seconds, always: what the guard knew and decided.
//!
//! A ring of fixed size that never allocates and never fails. On a stop the host writes it to a file; the MCU sends
//! it on request. Entries are small and typed, so that the ring costs a copy of a few words per tick.

use floorguard_types::time::Stamp;
use heapless::Vec;

/// Ten seconds at one entry per 10 ms tick, plus capacity for 24 events a second between the ticks.
pub const BLACK_BOX_ENTRIES: usize = 1_240;

/// A ring of stamped entries.
#[derive(Clone, Debug)]
pub struct BlackBox<T, const N: usize = BLACK_BOX_ENTRIES> {
    entries: Vec<(Stamp, T), N>,
    next: usize,
    written: u64,
}

impl<T: Copy, const N: usize> BlackBox<T, N> {
    /// An empty ring.
    #[must_use]
    pub const fn new() -> Self {
        Self { entries: Vec::new(), next: 0, written: 0 }
    }

    /// Appends an entry; when full, the oldest one is dropped.
    pub fn record(&mut self, stamp: Stamp, entry: T) {
        if let Err(entry) = self.entries.push((stamp, entry))
            && let Some(slot) = self.entries.get_mut(self.next)
        {
            *slot = entry;
        }
        self.next = self.next.saturating_add(1).checked_rem(N).unwrap_or(0);
        self.written = self.written.saturating_add(1);
    }

    /// All entries, oldest first.
    pub fn iter(&self) -> impl Iterator<Item = (Stamp, T)> + '_ {
        let (newer, older) = self.entries.split_at(self.next.min(self.entries.len()));
        older.iter().chain(newer).copied()
    }

    /// The entries that came after the first `written` ones, oldest first: those that are still there.
    pub fn since(&self, written: u64) -> impl Iterator<Item = (Stamp, T)> + '_ {
        let new = usize::try_from(self.written.saturating_sub(written)).unwrap_or(usize::MAX);
        self.iter().skip(self.entries.len().saturating_sub(new))
    }

    /// Entries ever written; those before the last `N` are gone.
    #[must_use]
    pub const fn written(&self) -> u64 {
        self.written
    }
}

impl<T: Copy, const N: usize> Default for BlackBox<T, N> {
    fn default() -> Self {
        Self::new()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::vec;
    use std::vec::Vec;

    #[test]
    fn oldest_entries_are_dropped_in_order() {
        let mut ring = BlackBox::<u32, 3>::new();
        for entry in 0..5 {
            ring.record(Stamp::from_micros(u64::from(entry) * 10), entry);
        }
        let kept: Vec<u32> = ring.iter().map(|(_, entry)| entry).collect();
        assert_eq!(kept, [2, 3, 4]);
        assert_eq!(ring.written(), 5);
        let since = |written| ring.since(written).map(|(_, entry)| entry).collect::<Vec<u32>>();
        assert_eq!((since(0), since(4), since(5)), (vec![2, 3, 4], vec![4], vec![]));
    }
}
