//! One revolution of the lidar as an organised range image, kept in the integers of the wire.
//!
//! Neighbourhood is index arithmetic: ring ± 1, column ± 1. A column that was never measured (lost packet, blind
//! sector) is *unknown*; a measured cell without a return is unknown too. Neither is free.

use super::lidar_packet::Reflectivity;
use crate::capacities::{SWEEP_COLUMNS, SWEEP_RINGS};
use crate::geometry::Pose2;
use crate::profile::{Entry, Native, Of, Profile};
use crate::time::Stamp;

/// One column: 16 rings, ordered by elevation, 0 lowest.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SweepColumnOf<P: Profile, const RINGS: usize = SWEEP_RINGS> {
    /// Azimuth, hundredths of a degree, clockwise from the sensor's forward.
    pub azimuth_cdeg: u16,
    /// A packet that covers this column arrived.
    pub measured: bool,
    /// Microseconds after [`Sweep::stamp`].
    pub offset_us: u32,
    /// Range per ring in [`Sweep::range_unit_mm`]; 0 = no return = unknown.
    pub range_raw: [u16; RINGS],
    /// Calibrated reflectivity per ring.
    pub reflectivity: Reflectivity<P, Of<RINGS>>,
}

/// A column in the memory of the target.
pub type SweepColumn<const RINGS: usize = SWEEP_RINGS> = SweepColumnOf<Native, RINGS>;

impl<P: Profile, const RINGS: usize> SweepColumnOf<P, RINGS> {
    /// A column about which nothing is known.
    pub const UNKNOWN: Self = Self {
        azimuth_cdeg: 0,
        measured: false,
        offset_us: 0,
        range_raw: [0; RINGS],
        reflectivity: Entry::BLANK,
    };
}

/// Where the robot stood while a column was measured, relative to where it stood at the end of the sweep.
pub type SweepPose = Pose2;

/// A revolution. About 100 KiB for `Host`, 71 KiB for `Board`: keep it in a static and pass references.
///
/// ```
/// use floorguard_types::sensing::{Sweep, SweepColumn};
///
/// static EMPTY: Sweep = Sweep::EMPTY;
/// assert!(EMPTY.used_columns().is_empty());
/// // A column that no packet brought is unknown.
/// assert!(!SweepColumn::<16>::UNKNOWN.measured);
/// ```
#[derive(Clone, Debug)]
pub struct SweepOf<P: Profile, const RINGS: usize = SWEEP_RINGS> {
    /// When the first column was measured, on the robot's clock.
    pub stamp: Stamp,
    /// When the last column was measured.
    pub end_stamp: Stamp,
    /// Millimetres per count of `range_raw`.
    pub range_unit_mm: u8,
    /// Columns in use; entries above are [`SweepColumn::UNKNOWN`].
    pub column_count: usize,
    /// The columns, in time order (azimuth rising, clockwise).
    pub columns: [SweepColumnOf<P, RINGS>; SWEEP_COLUMNS],
    /// Packets that went into it.
    pub packets: u16,
    /// Packets that should have gone into it and did not arrive.
    pub lost_packets: u16,
    /// Columns that did not fit any more.
    pub dropped_columns: u16,
}

/// A revolution in the memory of the target.
pub type Sweep<const RINGS: usize = SWEEP_RINGS> = SweepOf<Native, RINGS>;

impl<P: Profile, const RINGS: usize> SweepOf<P, RINGS> {
    /// A sweep without a single column.
    pub const EMPTY: Self = Self {
        stamp: Stamp::ZERO,
        end_stamp: Stamp::ZERO,
        range_unit_mm: 2,
        column_count: 0,
        columns: [SweepColumnOf::UNKNOWN; SWEEP_COLUMNS],
        packets: 0,
        lost_packets: 0,
        dropped_columns: 0,
    };

    /// The columns in use.
    #[must_use]
    pub fn used_columns(&self) -> &[SweepColumnOf<P, RINGS>] {
        self.columns.get(..self.column_count).unwrap_or(&self.columns)
    }
}
