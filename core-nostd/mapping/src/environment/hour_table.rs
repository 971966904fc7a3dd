//! Who passed which cell in which hour of the week: a table of fixed size for the few pairs that ever occur.
//!
//! A full table would need 168 numbers for each of a quarter of a million cells, nearly all of them zero. Open
//! addressing with a bounded probe (book, Environment: Hour table) holds what occurred; what does not fit is counted,
//! and the totals of the heat map, which are kept elsewhere, stay right.

use floorguard_types::number::{exact_usize, truncating_u8, truncating_u32};

use super::wall_time::HOURS_OF_WEEK;

/// Places examined before an entry counts as lost (book, Environment: Hour table).
const PROBES_MAX: usize = 64;
/// Key of a place that holds nothing.
const EMPTY: u32 = u32::MAX;

/// What happened in a cell in one hour of the week.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct HourEntry {
    key: u32,
    /// Tracks that entered.
    pub visits: u16,
    /// Time people spent, hundredths of a second.
    pub dwell_cs: u32,
}

impl HourEntry {
    /// A place that holds nothing.
    pub const NOTHING: Self = Self { key: EMPTY, visits: 0, dwell_cs: 0 };

    /// The cell and the hour of the week, `None` if it holds nothing.
    #[must_use]
    pub fn cell_and_hour(&self) -> Option<(usize, u8)> {
        let hours = truncating_u32(HOURS_OF_WEEK);
        (self.key != EMPTY).then_some((exact_usize(self.key / hours), truncating_u8(self.key % hours)))
    }
}

/// The table, in storage `S`.
#[derive(Clone, Debug)]
pub struct HourTable<S> {
    entries: S,
    lost: u32,
}

impl<S: AsRef<[HourEntry]> + AsMut<[HourEntry]>> HourTable<S> {
    /// An empty table; what the storage holds is cleared.
    #[must_use]
    pub fn new(mut storage: S) -> Self {
        storage.as_mut().fill(HourEntry::NOTHING);
        Self { entries: storage, lost: 0 }
    }

    /// Adds visits and time to a cell and hour. False, and counted, where the capacity is exhausted.
    pub fn add(&mut self, cell: usize, hour: u8, visits: u16, dwell_cs: u32) -> bool {
        let hours = truncating_u32(HOURS_OF_WEEK);
        let key =
            u32::try_from(cell).ok().and_then(|cell| cell.checked_mul(hours)?.checked_add(u32::from(hour)));
        let capacity = self.entries.as_ref().len();
        let place = key.filter(|key| *key != EMPTY && u32::from(hour) < hours).and_then(|key| {
            let start = usize::try_from(mix(key)).unwrap_or_default();
            (0..PROBES_MAX.min(capacity))
                .map(|probe| start.wrapping_add(probe) % capacity.max(1))
                .find(|at| self.entries.as_ref().get(*at).is_some_and(|e| e.key == key || e.key == EMPTY))
                .map(|at| (at, key))
        });
        match place.and_then(|(at, key)| self.entries.as_mut().get_mut(at).map(|entry| (entry, key))) {
            Some((entry, key)) => {
                entry.key = key;
                entry.visits = entry.visits.saturating_add(visits);
                entry.dwell_cs = entry.dwell_cs.saturating_add(dwell_cs);
                true
            }
            None => {
                self.lost = self.lost.saturating_add(1);
                false
            }
        }
    }

    /// Everything that is held, in no particular but always the same order.
    pub fn iter(&self) -> impl Iterator<Item = &HourEntry> {
        self.entries.as_ref().iter().filter(|entry| entry.key != EMPTY)
    }

    /// Entries that did not fit, counted.
    #[must_use]
    pub const fn lost(&self) -> u32 {
        self.lost
    }
}

/// Spreads neighbouring keys (the finaliser of MurmurHash3).
const fn mix(key: u32) -> u32 {
    let mut hash = key;
    hash ^= hash >> 16;
    hash = hash.wrapping_mul(0x85eb_ca6b);
    hash ^= hash >> 13;
    hash = hash.wrapping_mul(0xc2b2_ae35);
    hash ^ (hash >> 16)
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::{vec, vec::Vec};

    #[test]
    fn holds_what_is_added() {
        let mut table = HourTable::new(vec![HourEntry::NOTHING; 4_096]);
        for cell in 0..500 {
            for hour in [0, 12, 167] {
                assert!(table.add(cell, hour, 1, 10) && table.add(cell, hour, 2, 5));
            }
        }
        let mut all: Vec<_> =
            table.iter().map(|e| (e.cell_and_hour().unwrap(), e.visits, e.dwell_cs)).collect();
        all.sort_unstable();
        assert_eq!(all.len(), 1_500);
        assert_eq!(all[1_499], ((499, 167), 3, 15));
        assert!(all.iter().all(|(_, visits, dwell)| (*visits, *dwell) == (3, 15)));
        assert_eq!(table.lost(), 0);
    }

    #[test]
    fn overflow_is_counted() {
        let mut table = HourTable::new([HourEntry::NOTHING; 8]);
        let taken = (0..20).filter(|cell| table.add(*cell, 3, 1, 0)).count();
        assert_eq!((taken, table.lost(), table.iter().count()), (8, 12, 8));
        assert!(!table.add(usize::MAX, 0, 1, 0) && !table.add(0, 168, 1, 0));
        assert!(!HourTable::new([HourEntry::NOTHING; 0]).add(0, 0, 1, 0));
    }
}
