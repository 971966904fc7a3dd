//! What the observations of a cell say together, and from where on that is dirt.

use floorguard_types::number::saturating_u8;

/// Steps of a kept score: sixths of a natural logarithm up to 42.
const STEPS: f32 = 6.0;

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
        Self(saturating_u8((score * STEPS + 0.5).clamp(0.0, 255.0)))
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
    pub(super) fn is_usual(self, limit: DirtLimit) -> bool {
        self.median <= limit.score && self.median_tint <= limit.tint
    }
}
