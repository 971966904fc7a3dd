//! Why a scan or boxes are refused. Nothing of what is refused is inserted.

use core::fmt;

/// Why a scan is not inserted.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum ScanError {
    /// The motor is commanded to turn, but its angle has not changed for so long: mechanics or encoder. All columns would
    /// lie in one direction. It ends when the angle follows again.
    MotorStalled {
        /// Since the angle last moved, microseconds.
        standing_us: u64,
    },
    /// No angle of the motor lies near enough before and after a beam: the nearest is so far from it. The scan belongs to
    /// no direction; wait for the angle, or correct the clocks.
    AngleMissing {
        /// Distance in time, microseconds; the largest number if there is no angle at all.
        gap_us: u64,
    },
    /// Not newer than the scan before.
    OutOfOrder {
        /// How much older, microseconds; 0 for the same stamp.
        behind_us: u64,
    },
    /// Fewer than two beams, or more than the window takes.
    BeamCount {
        /// What the scan has.
        beams: usize,
    },
    /// An angle, the time from beam to beam or the robot's pose is not finite, or a step is not positive.
    NotFinite,
}

/// Why an angle of the motor is not taken.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum MotorError {
    /// Not newer than the sample before.
    OutOfOrder {
        /// How much older, microseconds; 0 for the same stamp.
        behind_us: u64,
    },
    /// Angle or commanded speed is not finite.
    NotFinite,
}

/// Why person boxes are not taken. The boxes before stay valid until they expire.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum BoxError {
    /// Not newer than the picture before.
    OutOfOrder {
        /// How much older, microseconds; 0 for the same stamp.
        behind_us: u64,
    },
    /// So old that the people may be elsewhere.
    Stale {
        /// Age, microseconds.
        age_us: u64,
    },
    /// The picture claims to come from the future by more than the clocks may differ.
    Future {
        /// By so much, microseconds.
        ahead_us: u64,
    },
    /// More boxes than the window takes.
    TooMany {
        /// So many.
        boxes: usize,
    },
    /// A box whose bounds are not finite, or whose lower bound is not below the upper one.
    Bounds {
        /// Which.
        index: usize,
    },
    /// The robot's pose is not finite.
    NotFinite,
}

impl fmt::Display for ScanError {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::MotorStalled { standing_us } => {
                write!(formatter, "the lidar's motor is commanded but has stood for {standing_us} µs")
            }
            Self::AngleMissing { gap_us } => {
                write!(formatter, "the nearest angle of the lidar's motor is {gap_us} µs from a beam")
            }
            Self::OutOfOrder { behind_us } => {
                write!(formatter, "the scan is {behind_us} µs older than the one before")
            }
            Self::BeamCount { beams } => write!(formatter, "a scan of {beams} beams does not fit"),
            Self::NotFinite => {
                formatter.write_str("an angle, a period or the pose of the scan is not a number")
            }
        }
    }
}

impl fmt::Display for MotorError {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::OutOfOrder { behind_us } => {
                write!(formatter, "the motor's angle is {behind_us} µs older than the one before")
            }
            Self::NotFinite => formatter.write_str("the motor's angle or speed is not a number"),
        }
    }
}

impl fmt::Display for BoxError {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::OutOfOrder { behind_us } => {
                write!(formatter, "the person boxes are {behind_us} µs older than those before")
            }
            Self::Stale { age_us } => write!(formatter, "the person boxes are {age_us} µs old"),
            Self::Future { ahead_us } => {
                write!(formatter, "the person boxes are {ahead_us} µs in the future")
            }
            Self::TooMany { boxes } => write!(formatter, "{boxes} person boxes do not fit"),
            Self::Bounds { index } => write!(formatter, "the bounds of person box {index} are in disorder"),
            Self::NotFinite => formatter.write_str("the pose of the person boxes is not a number"),
        }
    }
}

impl core::error::Error for ScanError {}
impl core::error::Error for MotorError {}
impl core::error::Error for BoxError {}
