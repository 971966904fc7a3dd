//! One cell of the map of seen dirt: its last nine observations and what they first said.
//!
//! The observations are bits of a register, newest lowest; their median is a count of bits (algorithms F.2). What the
//! mission first perceived is frozen as soon as nine are in or the cell was out of view for a while, so that cleaning
//! does not change the report of what was there before.

/// Observations that are kept.
pub(super) const WINDOW: u8 = 9;
const WINDOW_BITS: u16 = (1 << WINDOW) - 1;
/// Fewer say nothing.
const OBSERVATIONS_MIN: u8 = 3;
/// Out of view for longer than this, what was first perceived is final, seconds.
const OUT_OF_VIEW_S: u32 = 10;

/// What is known about a cell.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum CellState {
    /// Too few observations: neither clean nor dirty.
    #[default]
    Unknown,
    /// Most observations saw no dirt.
    Clean,
    /// Most observations saw dirt.
    Dirty,
}

/// One cell.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct SeenCell {
    /// Observations, newest in the lowest bit; 1 is dirt.
    history: u16,
    /// Observations so far, up to the window.
    count: u8,
    /// All observations so far.
    total: u16,
    first: CellState,
    is_frozen: bool,
    /// Score above the detector's threshold, sixteenths of a natural logarithm; mean of the dirty observations.
    score: u8,
    /// Seconds of the monotonic clock when the live median became dirty, and of the last observation.
    dirty_since_s: u32,
    last_s: u32,
    /// Pixels of the frame that is being added, and dirty ones.
    pub(super) pixels: u16,
    pub(super) dirty_pixels: u16,
    /// Sum of the scores of those, units.
    pub(super) score_sum: f32,
}

impl SeenCell {
    /// What the newest observations say.
    #[must_use]
    pub const fn live(&self) -> CellState {
        if self.count < OBSERVATIONS_MIN {
            CellState::Unknown
        } else if self.history.count_ones().saturating_mul(2) > self.count as u32 {
            CellState::Dirty
        } else {
            CellState::Clean
        }
    }

    /// What the mission first perceived.
    #[must_use]
    pub const fn first(&self) -> CellState {
        if self.is_frozen { self.first } else { self.live() }
    }

    /// Observations in this mission.
    #[must_use]
    pub const fn observations(&self) -> u16 {
        self.total
    }

    /// Mean by which dirty observations exceeded the detector's threshold, natural logarithms.
    #[must_use]
    pub fn score(&self) -> f32 {
        f32::from(self.score) / 16.0
    }

    /// Second of the monotonic clock at which the cell became dirty; 0 if it never was.
    #[must_use]
    pub const fn dirty_since_s(&self) -> u32 {
        self.dirty_since_s
    }

    /// Adds an observation from a new viewpoint, with the score above the threshold where it is dirt.
    pub(super) fn observe(&mut self, excess: Option<f32>, now_s: u32) {
        let was_away = self.total > 0 && now_s.saturating_sub(self.last_s) > OUT_OF_VIEW_S;
        if !self.is_frozen && (self.count == WINDOW || (was_away && self.count >= OBSERVATIONS_MIN)) {
            (self.first, self.is_frozen) = (self.live(), true);
        }
        let was_dirty = self.live() == CellState::Dirty;
        self.history = ((self.history << 1) | u16::from(excess.is_some())) & WINDOW_BITS;
        self.count = self.count.saturating_add(1).min(WINDOW);
        self.total = self.total.saturating_add(1);
        self.last_s = now_s;
        if let Some(excess) = excess {
            let new = (excess * 16.0).clamp(0.0, 255.0);
            let old = f32::from(self.score);
            self.score = (if old > 0.0 { 0.75 * old + 0.25 * new } else { new }) as u8;
        }
        if self.live() == CellState::Dirty && !was_dirty {
            self.dirty_since_s = now_s;
        }
    }

    /// Starts a mission: what is first perceived is open again; the live state is kept.
    pub(super) fn begin_mission(&mut self) {
        self.is_frozen = false;
        self.history = 0;
        self.count = 0;
        self.total = 0;
        self.score = 0;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_median_decides() {
        let mut cell = SeenCell::default();
        for (index, is_dirt) in [true, true, false, true, false].into_iter().enumerate() {
            let expected = [
                CellState::Unknown,
                CellState::Unknown,
                CellState::Unknown,
                CellState::Dirty,
                CellState::Dirty,
            ];
            assert_eq!(cell.live(), expected[index], "{index}");
            cell.observe(is_dirt.then_some(2.0), index as u32);
        }
        assert_eq!((cell.live(), cell.score(), cell.dirty_since_s()), (CellState::Dirty, 2.0, 2));
        cell.observe(None, 6);
        assert_eq!(cell.live(), CellState::Clean, "three of six are no majority");
    }

    /// Cleaning changes the live state and not what was first perceived.
    #[test]
    fn the_first_perception_stays() {
        let mut cell = SeenCell::default();
        (0..4).for_each(|second| cell.observe(Some(1.0), second));
        (60..72).for_each(|second| cell.observe(None, second));
        assert_eq!((cell.first(), cell.live()), (CellState::Dirty, CellState::Clean));
        cell.begin_mission();
        assert_eq!((cell.first(), cell.live()), (CellState::Unknown, CellState::Unknown));
    }
}
