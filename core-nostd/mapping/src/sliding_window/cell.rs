//! A cell of the window: eight bytes.

use floorguard_types::number::{saturating_u16, truncating_u16};
use floorguard_types::time::Stamp;

/// Steps in which a cell keeps its elevation: an eighth of a millimetre, so that thousands of compensated movements do not
/// add up to a cell, and 16 bits reach 8.19 m.
pub const ELEVATION_STEP_M: f32 = 1.25e-4;
const STEPS_PER_METRE: f32 = 8_000.0;
const ELEVATION_MAX_M: f32 = 8.19;
/// Ages of cells are counted in tenths of a second.
const TICK_US: u64 = 100_000;
/// How long a place counts as a person's after it was seen as that: two seconds, in ticks. A walker leaves it sooner.
pub(super) const PERSON_TICKS: u16 = 20;
/// The same in microseconds.
pub const PERSON_EXPIRY_US: u64 = 2_000_000;

/// What a cell holds.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[repr(u8)]
pub enum CellContent {
    /// Nothing was seen here. Not the same as free.
    #[default]
    Empty,
    /// The front-most surface of something.
    Surface,
    /// A surface within a person's box: erased from the window, shown on the debug layer, and not navigable until it expires.
    Person,
}

/// One cell. Invariant: the place within the cell is meaningless where `content` is empty.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[repr(align(4))] // A copy is two words.
pub struct WindowCell {
    /// In [`ELEVATION_STEP_M`].
    pub(super) elevation: u16,
    /// When it was written, tenths of a second, wrapping.
    pub(super) tick: u16,
    /// Place within the cell, in 256ths of its edge from the centre.
    pub(super) along: i8,
    pub(super) up: i8,
    pub(super) content: CellContent,
    /// Points that were written since it was last empty.
    pub(super) hits: u8,
}

impl WindowCell {
    /// Nothing.
    pub const EMPTY: Self =
        Self { elevation: 0, tick: 0, along: 0, up: 0, content: CellContent::Empty, hits: 0 };

    /// What it holds. A person's mark stays until the window lets it expire.
    #[must_use]
    pub const fn content(&self) -> CellContent {
        self.content
    }

    /// Points that were written since it was last empty, at most 255.
    #[must_use]
    pub const fn hits(&self) -> u8 {
        self.hits
    }

    /// Age in tenths of a second; right up to an hour and 49 minutes.
    #[must_use]
    pub fn age_ticks(&self, now: Stamp) -> u16 {
        tick_of(now).wrapping_sub(self.tick)
    }
}

/// The tenth of a second of a stamp, wrapping.
pub(super) fn tick_of(stamp: Stamp) -> u16 {
    truncating_u16(stamp.as_micros() / TICK_US)
}

/// An elevation as a cell keeps it; `None` below zero, beyond 8.19 m and for NaN.
#[inline]
pub(super) fn kept_elevation(elevation_m: f32) -> Option<u16> {
    let is_inside = (0.0..=ELEVATION_MAX_M).contains(&elevation_m);
    is_inside.then(|| saturating_u16(elevation_m * STEPS_PER_METRE + 0.5))
}
