//! Who stopped the robot: the stop ends when that person is seen to part from it (FG-REQ-086).

use floorguard_types::number::truncating_u32;
use floorguard_types::time::{Age, Stamp};

/// Lists in a row that must show it: one alone may be noise.
const LISTS: u8 = 2;

/// The person whom the robot would have reached, and what the lists have shown of that person since.
///
/// Who is in no list any more may stand behind a shelf: that is silence, and the stop lasts as long as without this.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Stopper {
    pub(crate) id: u32,
    is_known: bool,
    pub(crate) parting_lists: u8,
    newest: Stamp,
    /// A sum over the others: with a flipped bit nobody is known, and no stop ends sooner.
    sum: u32,
}

impl Stopper {
    /// Nobody has stopped the robot.
    pub const NONE: Self =
        Self { id: 0, is_known: false, parting_lists: 0, newest: Stamp::ZERO, sum: u32::MAX };

    fn new((id, is_known): (u32, bool), parting_lists: u8, newest: Stamp) -> Self {
        let unsummed = Self { id, is_known, parting_lists, newest, sum: 0 };
        Self { sum: unsummed.summed(), ..unsummed }
    }

    fn summed(&self) -> u32 {
        let us = self.newest.as_micros();
        let counts = u32::from(self.parting_lists) | (u32::from(self.is_known) << 16);
        !(self.id ^ truncating_u32(us) ^ truncating_u32(us.rotate_left(32)) ^ counts)
    }

    fn is_whole(&self) -> bool {
        self.sum == self.summed()
    }

    /// Who it is.
    #[must_use]
    pub fn id(&self) -> Option<u32> {
        if self.is_known && self.is_whole() { Some(self.id) } else { None }
    }

    /// A list of people of a moment: whom the robot would reach now, and whether the one who stopped it parts from it. `true`: the stop
    /// may end. A list that is not newer than the last one, or not from the past, shows nothing.
    pub fn follow(&mut self, (stops, parts): (Option<u32>, bool), stamp: Stamp, now: Stamp) -> bool {
        if !self.is_whole() {
            *self = Self::new((0, false), 0, now);
        }
        if let Some(id) = stops {
            *self = Self::new((id, true), 0, self.newest.max(stamp.min(now)));
            return false;
        }
        let is_new = stamp > self.newest && matches!(stamp.age(now), Age::Past(_));
        if !is_new {
            return false;
        }
        let parting_lists = if parts { self.parting_lists.saturating_add(1) } else { 0 };
        let ends = self.is_known && parting_lists >= LISTS;
        *self = Self::new((self.id, self.is_known && !ends), parting_lists, stamp);
        ends
    }
}
