//! What the guard can demand, in order of severity, and the state it shows.

use core::fmt;

/// Ordered: the most severe active cause wins (FG-REQ-001). Stop categories after IEC 60204-1 (book, Guard: Stop
/// categories).
///
/// ```
/// use floorguard_guard::Action;
///
/// assert!(Action::None < Action::Limit && Action::Category1 < Action::Category0);
/// assert!(Action::Category2.stops() && !Action::Limit.stops());
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Action {
    /// Nothing to object.
    #[default]
    None,
    /// Move, but slower.
    Limit,
    /// Controlled stop; power stays on.
    Category2,
    /// Controlled stop, then torque off.
    Category1,
    /// Torque off at once.
    Category0,
}

impl Action {
    /// The robot must come to rest.
    #[must_use]
    pub fn stops(self) -> bool {
        self >= Self::Category2
    }
}

impl fmt::Display for Action {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        out.write_str(match self {
            Self::None => "free",
            Self::Limit => "speed limited",
            Self::Category2 => "stop and hold (category 2)",
            Self::Category1 => "stop, then torque off (category 1)",
            Self::Category0 => "torque off (category 0)",
        })
    }
}

/// The state to show (book, Guard: Causes). Priority: Latched > Init > AwaitsStart > Stop > Slow > Run.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum GuardState {
    /// A required source has not been healthy yet.
    #[default]
    Init,
    /// Free to move within the configured limits.
    Run,
    /// Moving under a reduced limit.
    Slow,
    /// Standing; goes on by itself when the cause is gone.
    Stop,
    /// Standing; needs an operator's reset, and then a start command.
    Latched,
    /// Standing; ready, and waits for the start command.
    AwaitsStart,
}
