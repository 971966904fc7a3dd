//! The people who triggered a stop. The stop ends when all of them are seen to diverge from the robot (FG-REQ-086).

use floorguard_types::number::truncating_u32;
use floorguard_types::time::{Age, Stamp};

/// Consecutive lists that must show it: one alone may be noise.
const LISTS: u8 = 2;
/// A bit for each person that is kept. A stop for more people lasts until a second after the last evidence.
const BITS: [u8; 4] = [1, 2, 4, 8];

/// The people on a collision course with the robot, and what the lists of people have shown since.
///
/// A person who disappears from the lists may stand behind a shelf: silence ends no stop sooner.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct StopTriggers {
    pub(crate) ids: [u32; BITS.len()],
    /// Which of `ids` are people.
    known: u8,
    /// There were more people than bits, or memory was corrupted: the list is not complete.
    is_incomplete: bool,
    pub(crate) diverging_lists: u8,
    newest: Stamp,
    /// Sum over the other fields.
    sum: u32,
}

impl StopTriggers {
    /// No person has triggered a stop; with its sum.
    pub const NONE: Self = Self {
        ids: [0; BITS.len()],
        known: 0,
        is_incomplete: false,
        diverging_lists: 0,
        newest: Stamp::ZERO,
        sum: u32::MAX,
    };

    fn summed(&self) -> u32 {
        let us = self.newest.as_micros();
        let flags = u32::from_le_bytes([self.known, u8::from(self.is_incomplete), self.diverging_lists, 0]);
        let times = truncating_u32(us) ^ truncating_u32(us.rotate_left(32)).rotate_left(7);
        !self.ids.iter().fold(flags ^ times, |sum, id| sum.rotate_left(5) ^ id)
    }

    fn is_whole(&self) -> bool {
        self.sum == self.summed()
    }

    /// Changes it. After a corruption the list is empty and incomplete.
    fn change(&mut self, by: impl FnOnce(&mut Self)) {
        if !self.is_whole() {
            *self = Self { is_incomplete: true, ..Self::NONE };
        }
        by(self);
        self.sum = self.summed();
    }

    /// The bit of a person who triggered the stop; 0 for any other person.
    #[must_use]
    pub fn bit(&self, id: u32) -> u8 {
        let found = self.ids.iter().zip(BITS).find(|(known, bit)| **known == id && self.known & bit != 0);
        found.filter(|_| self.is_whole()).map_or(0, |(_, bit)| bit)
    }

    /// This person is on a collision course.
    pub fn add(&mut self, id: u32) {
        if self.bit(id) != 0 {
            return;
        }
        self.change(|triggers| {
            let known = triggers.known;
            match triggers.ids.iter_mut().zip(BITS).find(|(_, bit)| known & bit == 0) {
                Some((place, bit)) => (*place, triggers.known) = (id, known | bit),
                None => triggers.is_incomplete = true,
            }
        });
    }

    /// No stop for people is in force: the triggers of the last one are obsolete.
    pub fn forget(&mut self) {
        if self.known != 0 || self.is_incomplete || !self.is_whole() {
            let newest = if self.is_whole() { self.newest } else { Stamp::ZERO };
            *self = Self::NONE;
            self.change(|triggers| triggers.newest = newest);
        }
    }

    /// After a whole list of people: whether any of them is on a collision course, and the bits of those who diverge. `true`: the
    /// stop may end. A list that is not newer than the last one, or not from the past, shows nothing.
    pub fn follow(&mut self, (reaches, diverging): (bool, u8), stamp: Stamp, now: Stamp) -> bool {
        let is_new = stamp > self.newest && matches!(stamp.age(now), Age::Past(_));
        if !(is_new || reaches) {
            return false;
        }
        self.change(|triggers| {
            let all_diverge = !reaches && diverging == triggers.known;
            triggers.diverging_lists =
                if all_diverge { triggers.diverging_lists.saturating_add(1) } else { 0 };
            triggers.newest = triggers.newest.max(stamp.min(now));
        });
        self.known != 0 && !self.is_incomplete && self.diverging_lists >= LISTS
    }
}
