//! Who stopped the robot: the stop ends when that person is seen to part from it (FG-REQ-086).

use floorguard_types::time::{Age, Stamp};

/// Lists in a row that must show it: one alone may be noise.
const LISTS: u8 = 2;

/// The person whom the robot would have reached, and what the lists have shown of that person since.
///
/// Who is in no list any more may stand behind a shelf: that is silence, and the stop lasts as long as without this.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Stopper {
    pub(crate) id: u32,
    pub(crate) is_known: bool,
    pub(crate) parting_lists: u8,
    pub(crate) newest: Stamp,
}

impl Stopper {
    /// Nobody has stopped the robot.
    pub const NOBODY: Self = Self { id: 0, is_known: false, parting_lists: 0, newest: Stamp::ZERO };

    /// Who it is.
    #[must_use]
    pub const fn id(&self) -> Option<u32> {
        if self.is_known { Some(self.id) } else { None }
    }

    /// A list of people of a moment: whom the robot would reach now, and whether the one who stopped it parts from it. `true`: the stop
    /// may end. A list that is not newer than the last one, or not from the past, shows nothing.
    pub fn follow(&mut self, (stops, parts): (Option<u32>, bool), stamp: Stamp, now: Stamp) -> bool {
        if let Some(id) = stops {
            *self = Self { id, is_known: true, parting_lists: 0, newest: self.newest.max(stamp.min(now)) };
            return false;
        }
        let is_new = stamp > self.newest && matches!(stamp.age(now), Age::Past(_));
        if !is_new {
            return false;
        }
        self.newest = stamp;
        self.parting_lists = if parts { self.parting_lists.saturating_add(1) } else { 0 };
        let ends = self.is_known && self.parting_lists >= LISTS;
        self.is_known &= !ends;
        ends
    }
}
