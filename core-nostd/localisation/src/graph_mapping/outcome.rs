//! What became of scans and of loops.

/// What a scan became.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum MappingStep {
    /// The robot has hardly moved: the pose is odometry's since the last match.
    Passed,
    /// Matched, and not kept: the robot stands near the scan that was kept last.
    Matched,
    /// Kept under this number.
    Kept(u16),
    /// Matched against the map as it is, which is full.
    Full,
    /// Too few of its returns lie where others do: the pose is odometry's.
    Unlike,
}

/// What was searched; each number only grows.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct LoopCounters {
    /// Pairs of places.
    pub searched: u32,
    /// They do not fit.
    pub unlike: u32,
    /// The place lies at the rim of its window: what resembles it more may lie outside.
    pub at_rim: u32,
    /// One saw through what the other met.
    pub contradicted: u32,
    /// A second place fits nearly as well.
    pub ambiguous: u32,
    /// Accepted.
    pub accepted: u32,
    /// Accepted, and the list of edges was full.
    pub without_room: u32,
    /// Scans that were not kept because the map was full.
    pub scans_without_room: u32,
    /// Scans that fitted nowhere.
    pub scans_unlike: u32,
}
