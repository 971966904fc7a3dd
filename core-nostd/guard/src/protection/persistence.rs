//! A condition counts only when it has lasted.

use floorguard_types::time::{Age, Stamp};

/// A condition that must persist.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Persistence {
    pub(crate) since: Option<Stamp>,
}

impl Persistence {
    /// It is not true now.
    pub const NEVER: Self = Self { since: None };

    /// The condition has been true for at least `hold_us`.
    pub fn check(&mut self, condition: bool, (hold_us, now): (u64, Stamp)) -> bool {
        if !condition {
            self.since = None;
            return false;
        }
        let since = *self.since.get_or_insert(now);
        matches!(since.age(now), Age::Past(us) if us >= hold_us)
    }
}
