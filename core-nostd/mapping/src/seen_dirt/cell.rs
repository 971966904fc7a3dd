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

use super::rank::of_rank;
use super::tint::{FloorTints, KeptTint, kept, middle};

/// Observations that are kept.
pub(super) const WINDOW: usize = 9;
/// Fewer say nothing.
const OBSERVATIONS_MIN: u16 = 3;
/// Fewer do not close the question what a cell was at first: a glance from the edge of another lane proves nothing, and
/// a lane over the cell itself brings as many.
const FIRST_MIN: u16 = WINDOW as u16;
/// Out of view for longer than this, what was first perceived is final, seconds.
const OUT_OF_VIEW_S: u32 = 10;
/// Steps of a kept score: sixths of a natural logarithm up to 42.
const STEPS: f32 = 6.0;
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

/// What is known about a cell.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum CellState {
    /// Too few observations, or they disagree: neither clean nor dirty.
    #[default]
    Unknown,
    /// The median observation saw nothing, and the middle colour is none, that the floor does not show elsewhere.
    Clean,
    /// Eight of nine observations saw dirt; of fewer, all.
    Dirty,
}

/// Which of the two states of a cell.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SeenLayer {
    /// As it was when the mission first perceived it.
    First,
    /// As it is now.
    Live,
}

/// A score in the steps in which cells keep it.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord)]
pub struct KeptScore(pub(super) u8);

impl KeptScore {
    /// The nearest step; NaN is the lowest.
    #[must_use]
    pub fn of(score: f32) -> Self {
        // Within 0..=255 before it is cut.
        Self((score * STEPS + 0.5).clamp(0.0, 255.0) as u8)
    }

    /// Natural logarithms.
    #[must_use]
    pub fn score(self) -> f32 {
        f32::from(self.0) / STEPS
    }
}

/// What the newest observations of a cell say together.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Together {
    /// What eight of nine reach, or all of fewer.
    pub agreed: KeptScore,
    /// What every other one reaches.
    pub median: KeptScore,
    /// How strange the colour is that they agree on.
    pub tint: KeptScore,
    /// How strange the middle colour is.
    pub median_tint: KeptScore,
}

/// From which score, and from which strangeness of the colour on, a cell of this floor is dirty.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct DirtLimit {
    /// Of [`Together::agreed`].
    pub score: KeptScore,
    /// Of [`Together::tint`].
    pub tint: KeptScore,
}

impl DirtLimit {
    /// Both moved by so many natural logarithms; a limit that nothing exceeds stays one.
    #[must_use]
    pub fn moved(self, offset: f32) -> Self {
        let moved = |limit: KeptScore| match limit {
            KeptScore(u8::MAX) => limit,
            _ => KeptScore::of(limit.score() + offset),
        };
        Self { score: moved(self.score), tint: moved(self.tint) }
    }
}

impl Together {
    /// By how much the cell exceeds a limit, natural logarithms; above 0 it is dirty.
    #[must_use]
    pub fn excess(self, limit: DirtLimit) -> f32 {
        let score = self.agreed.score() - limit.score.score();
        score.max(self.tint.score() - limit.tint.score())
    }

    /// Neither the median nor the middle colour exceeds a limit.
    fn is_usual(self, limit: DirtLimit) -> bool {
        self.median <= limit.score && self.median_tint <= limit.tint
    }
}

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
            let bin = ((score - BINS_FROM) / BIN).min((BINS - 1) as f32) as usize;
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
                return BINS_FROM + BIN * (bin as f32 + 1.0 - part);
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
        self.total = if self.total >= 65_529 { WINDOW as u16 + 1 } else { self.total.saturating_add(1) };
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
mod tests {
    use super::*;

    const LIMIT: DirtLimit = DirtLimit { score: KeptScore(100), tint: KeptScore(100) };
    const FLOOR: FloorTints = FloorTints::AS_GUESSED;

    fn seen(scores: &[f32]) -> SeenCell {
        let mut cell = SeenCell::default();
        for (index, score) in scores.iter().enumerate() {
            cell.observe((KeptScore::of(*score), [0; 3]), &FLOOR, (LIMIT, index as u32));
        }
        cell
    }

    /// Unknown before three views. A reflection that stays for seven of nine makes no dirt, one that stays for five no
    /// clean floor either, and the tenth view replaces the first.
    #[test]
    fn dirt_is_what_views_agree_on() {
        let (dirt, floor) = (30.0, 8.0);
        let state = |scores: &[f32]| seen(scores).state(SeenLayer::Live, LIMIT);
        assert_eq!(seen(&[dirt, dirt]).live(), None);
        assert_eq!(state(&[dirt, dirt, dirt]), CellState::Dirty);
        assert_eq!(state(&[dirt, dirt, floor]), CellState::Unknown);
        assert_eq!(state(&[dirt, floor, floor]), CellState::Clean);
        let mut scores = [floor; 10];
        for (dirty, expected) in
            [(4, CellState::Clean), (5, CellState::Unknown), (7, CellState::Unknown), (8, CellState::Dirty)]
        {
            scores[..dirty].fill(dirt);
            assert_eq!(state(&scores[..9]), expected, "{dirty} of nine");
        }
        assert_eq!(state(&scores), CellState::Unknown);
    }

    #[test]
    fn parts_are_those_of_sorting() {
        let mut random = floorguard_types::random::Pcg32::new(3, 9);
        for count in 3..20_usize {
            let scores: std::vec::Vec<f32> = (0..count).map(|_| random.below(40) as f32).collect();
            let mut newest = scores[count.saturating_sub(WINDOW)..].to_vec();
            newest.sort_by(f32::total_cmp);
            let [agreed, median] =
                [newest.len() / 9, newest.len() / 2].map(|rank| KeptScore::of(newest[rank]));
            let together = Together { agreed, median, ..Together::default() };
            assert_eq!(seen(&scores).live(), Some(together), "{scores:?}");
        }
    }

    /// However often a cell was seen, a view replaces the oldest one.
    #[test]
    fn the_count_of_views_ends_without_a_gap() {
        let mut cell = seen(&[8.0; 9]);
        cell.total = 65_520;
        for view in 0..30_u32 {
            cell.observe((KeptScore(view as u8), [0; 3]), &FLOOR, (LIMIT, view));
            let mut newest = cell.window;
            newest.sort_unstable();
            let oldest = (view as u8).saturating_sub(8);
            assert!(view < 8 || newest.iter().copied().eq(oldest..=view as u8), "{view}: {newest:?}");
        }
        assert_eq!(cell.observations(), 30);
    }

    /// Cleaning changes the live state and not what was first perceived.
    #[test]
    fn the_first_perception_stays() {
        let mut cell = seen(&[30.0; 9]);
        (60..72).for_each(|second| cell.observe((KeptScore::of(9.0), [0; 3]), &FLOOR, (LIMIT, second)));
        assert_eq!(cell.state(SeenLayer::First, LIMIT), CellState::Dirty);
        assert_eq!(cell.state(SeenLayer::Live, LIMIT), CellState::Clean);
        (80..92).for_each(|second| cell.observe((KeptScore::of(30.0), [0; 3]), &FLOOR, (LIMIT, second)));
        assert_eq!(cell.state(SeenLayer::Live, LIMIT), CellState::Dirty);
        let since_s = [SeenLayer::First, SeenLayer::Live].map(|layer| cell.dirty_since_s(layer));
        assert_eq!(since_s, [2, 87], "spilled again: eight of nine at the eighth");
    }

    /// Four distant observations that saw nothing do not keep a closer one from finding dirt; nine
    /// observations do.
    #[test]
    fn a_glance_proves_no_floor_clean() {
        for (glances, expected) in [(4, CellState::Dirty), (9, CellState::Clean)] {
            let mut cell = seen(&std::vec![9.0; glances]);
            (60..72).for_each(|second| cell.observe((KeptScore::of(30.0), [0; 3]), &FLOOR, (LIMIT, second)));
            assert_eq!(cell.state(SeenLayer::First, LIMIT), expected, "{glances}");
        }
    }

    /// A colour that the floor has nowhere else is dirt though no pixel is rare. On which seven of nine agree, or five, it
    /// is none, but clean floor neither; and what was there at first stays known.
    #[test]
    fn a_strange_colour_is_dirt() {
        let usual = KeptScore::of(8.0);
        for (views, expected) in
            [(4, CellState::Clean), (5, CellState::Unknown), (7, CellState::Unknown), (8, CellState::Dirty)]
        {
            let mut cell = SeenCell::default();
            for view in 0..9_u32 {
                let tint = if view < views { [8, 0, -120] } else { [0, 0, 8] };
                cell.observe((usual, tint), &FLOOR, (LIMIT, view));
            }
            assert_eq!(cell.state(SeenLayer::Live, LIMIT), expected, "{views} of nine");
            (60..70).for_each(|second| cell.observe((usual, [0; 3]), &FLOOR, (LIMIT, second)));
            assert_eq!(cell.state(SeenLayer::First, LIMIT), expected, "{views} of nine");
            assert_eq!(cell.state(SeenLayer::Live, LIMIT), CellState::Clean);
        }
    }

    /// Where the floor is unknown no colour is strange, however the limits are moved.
    #[test]
    fn a_limit_that_nothing_exceeds_is_not_moved() {
        let unknown = DirtLimit { score: KeptScore(120), tint: KeptScore(255) };
        assert_eq!(unknown.moved(-1.0), DirtLimit { score: KeptScore(114), ..unknown });
        let saturated = Together { tint: KeptScore(255), ..Together::default() };
        assert!(saturated.excess(unknown.moved(-9.0)) <= 0.0);
    }

    /// A quarter of the pixels exceeds what is observed.
    #[test]
    fn an_observation_is_the_upper_quarter() {
        let mut cell = SeenCell::default();
        (0..32_u8).for_each(|pixel| cell.take(f32::from(pixel)));
        assert!((cell.upper_score() - 24.0).abs() < 0.6, "{}", cell.upper_score());
        assert!(cell.close(&FLOOR, (LIMIT, 1)) && !cell.close(&FLOOR, (LIMIT, 1)));
        assert_eq!(cell.observations(), 1);
    }
}
