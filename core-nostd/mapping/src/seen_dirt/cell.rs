//! One cell of the map of seen dirt: how dirty its last nine observations were, and what they first showed.
//!
//! An observation is the score that a quarter of the cell's pixels exceed, so that a chip or a knot of the floor is
//! none. The published map (Yan et al. 2020a, section 5.2) takes the median of the newest nine; but a lamp's reflection
//! stays over a cell for half of its views and longer. So dirt is what eight of nine agree on, and where only the
//! median says so it is unknown. Scores are kept and not only verdicts, because how dirty is dirty depends on the
//! floor, and a floor is known only after much of it was seen. Beside the score a cell keeps the colour of the
//! decimetre around it, for what tints a place and is no stranger in any pixel. What the mission first perceived is
//! frozen when the cell, well seen, was out of view for a while, so that cleaning does not change the report of what
//! was there before.

use super::limit::{CellState, DirtLimit, KeptScore, SeenLayer, Together};
use super::rank::of_rank;
use super::tint::{FloorTints, KeptTint, kept, middle};
use floorguard_types::number::{nearest_f32, saturating_usize, short_usize};

/// Observations that are kept.
pub(super) const WINDOW: usize = short_usize(KEPT);
const KEPT: u16 = 9;
/// Fewer say nothing.
const OBSERVATIONS_MIN: u16 = 3;
/// Fewer do not close the question what a cell was at first: a glance from the edge of another lane proves nothing, and
/// a lane over the cell itself brings as many.
const FIRST_MIN: u16 = KEPT;
/// Out of view for longer than this, what was first perceived is final, seconds.
const OUT_OF_VIEW_S: u32 = 10;
/// Counters of pixels by score, the first for scores from here on.
pub(super) const BINS: usize = 16;
const BINS_FROM: f32 = 6.0;
const BIN: f32 = 1.5;
/// Part of the pixels that exceed an observation: a quarter.
const UPPER_PART: u16 = 4;
/// One of so many observations may disagree.
const AGREED_PART: usize = WINDOW;
/// Fewest pixels of a cell that are an observation.
const PIXELS_MIN: u16 = 6;

/// One cell.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct SeenCell {
    /// The newest observations; the next one goes to the place `total` modulo nine.
    window: [u8; WINDOW],
    tints: [KeptTint; WINDOW],
    /// How strange the colour is that they agree on, and the middle one.
    strangeness: [KeptScore; 2],
    /// What the last observation made of it.
    is_dirty: bool,
    /// All observations so far.
    total: u16,
    first: Option<Together>,
    /// Seconds of the monotonic clock: since when what was first perceived, and the live state, is dirt, and the last
    /// observation.
    first_since_s: u32,
    dirty_since_s: u32,
    last_s: u32,
    /// Pixels of the frame that is being added, by score.
    pixels: u16,
    bins: [u8; BINS],
    /// Sum of the colours around it in this frame, and of their weights.
    colours: [f32; 4],
}

impl SeenCell {
    /// What the newest observations say; `None` for too few.
    #[must_use]
    pub fn live(&self) -> Option<Together> {
        let known = self.window.get(..usize::from(self.total)).unwrap_or(&self.window);
        // For a half, the upper median.
        let reached = |part: usize| of_rank(known, known.len() / part, Ord::cmp);
        let (agreed, median) = (reached(AGREED_PART)?, reached(2)?);
        let [tint, median_tint] = self.strangeness;
        let together = Together { agreed: KeptScore(agreed), median: KeptScore(median), tint, median_tint };
        (self.total >= OBSERVATIONS_MIN).then_some(together)
    }

    /// What the mission first perceived; `None` for too few observations.
    #[must_use]
    pub fn first(&self) -> Option<Together> {
        self.first.or_else(|| self.live())
    }

    /// What is known in a layer; `None` for too few observations.
    #[must_use]
    pub fn together(&self, layer: SeenLayer) -> Option<Together> {
        match layer {
            SeenLayer::First => self.first(),
            SeenLayer::Live => self.live(),
        }
    }

    /// By how much the cell exceeds a limit in a layer, natural logarithms; `None` for too few observations.
    #[must_use]
    pub fn excess(&self, layer: SeenLayer, limit: DirtLimit) -> Option<f32> {
        self.together(layer).map(|together| together.excess(limit))
    }

    /// The state in a layer, where dirt is what exceeds a limit.
    #[must_use]
    pub fn state(&self, layer: SeenLayer, limit: DirtLimit) -> CellState {
        match self.together(layer) {
            Some(together) if together.excess(limit) > 0.0 => CellState::Dirty,
            Some(together) if together.is_usual(limit) => CellState::Clean,
            _ => CellState::Unknown,
        }
    }

    /// Observations in this mission.
    #[must_use]
    pub const fn observations(&self) -> u16 {
        self.total
    }

    /// Of a cell that is dirty in a layer, the second of the monotonic clock since which it is perceived as that: from when
    /// on its views exceeded the limit of their time. Where only the limit of today makes it dirty, that is its last view:
    /// what it saw is what is dirt now.
    #[must_use]
    pub const fn dirty_since_s(&self, layer: SeenLayer) -> u32 {
        match (layer, self.first) {
            (SeenLayer::First, Some(_)) => self.first_since_s,
            _ if self.is_dirty => self.dirty_since_s,
            _ => self.last_s,
        }
    }

    /// Takes a pixel of the frame that is being added.
    pub(super) fn take(&mut self, score: f32) {
        self.pixels = self.pixels.saturating_add(1);
        if score >= BINS_FROM {
            // Within the counters before it is cut.
            let bin = saturating_usize(((score - BINS_FROM) / BIN).min(nearest_f32(BINS - 1)));
            if let Some(slot) = self.bins.get_mut(bin) {
                *slot = slot.saturating_add(1);
            }
        }
    }

    /// Takes colours of the frame that is being added, from the cell or near it, as a sum over pixels and their number.
    pub(super) fn tint(&mut self, colours: [f32; 4], weight: f32) {
        for (sum, value) in self.colours.iter_mut().zip(colours) {
            *sum += weight * value;
        }
    }

    /// Ends the frame: its pixels become an observation, if they are enough.
    pub(super) fn close(&mut self, floor: &FloorTints, when: (DirtLimit, u32)) -> bool {
        let is_seen = self.pixels >= PIXELS_MIN;
        if is_seen {
            let [l, a, b, weight] = self.colours;
            // Where nothing tells a colour it is as its surroundings.
            let mean = [l, a, b].map(|sum| if weight > 0.0 { sum / weight } else { 0.0 });
            self.observe((KeptScore::of(self.upper_score()), kept(mean)), floor, when);
        }
        (self.pixels, self.bins, self.colours) = (0, [0; BINS], [0.0; 4]);
        is_seen
    }

    /// The score that a quarter of the pixels exceed.
    fn upper_score(&self) -> f32 {
        let wanted = f32::from(self.pixels) / f32::from(UPPER_PART);
        let mut above = 0.0_f32;
        for (bin, count) in self.bins.iter().enumerate().rev() {
            let count = f32::from(*count);
            if above + count >= wanted && count > 0.0 {
                let part = (wanted - above) / count;
                return BINS_FROM + BIN * (nearest_f32(bin) + 1.0 - part);
            }
            above += count;
        }
        BINS_FROM
    }

    /// Adds an observation from a new viewpoint: its score and its colour on this floor.
    pub(super) fn observe(
        &mut self,
        (score, tint): (KeptScore, KeptTint),
        floor: &FloorTints,
        (limit, now_s): (DirtLimit, u32),
    ) {
        let was_away = self.total > 0 && now_s.saturating_sub(self.last_s) > OUT_OF_VIEW_S;
        if self.first.is_none() && was_away && self.total >= FIRST_MIN {
            (self.first, self.first_since_s) = (self.live(), self.dirty_since_s(SeenLayer::Live));
        }
        let place = usize::from(self.total) % WINDOW;
        if let (Some(slot), Some(tints)) = (self.window.get_mut(place), self.tints.get_mut(place)) {
            (*slot, *tints) = (score.0, tint);
        }
        // Where the count would end it begins again with the first place written, as it is now: 65,529 is a multiple of nine.
        self.total = if self.total >= 65_529 { KEPT + 1 } else { self.total.saturating_add(1) };
        self.last_s = now_s;
        self.strangeness = floor.strangeness(self.views()).map(KeptScore::of);
        let is_dirty = self.state(SeenLayer::Live, limit) == CellState::Dirty;
        if is_dirty && !self.is_dirty {
            self.dirty_since_s = now_s;
        }
        self.is_dirty = is_dirty;
    }

    /// The middle colour of the newest observations, Lab relative to the surroundings.
    pub(super) fn colour(&self) -> [f32; 3] {
        middle(self.views())
    }

    fn views(&self) -> &[KeptTint] {
        self.tints.get(..usize::from(self.total).min(WINDOW)).unwrap_or(&[])
    }
}

#[cfg(test)]
#[path = "cell_tests.rs"]
mod tests;
