//! The published detector: blocks whose texture a mixture, fitted to the blocks of the same image, explains badly.
//!
//! Dirt is what is rare, so the mixture must be too poor to give dirt a component of its own; weak components may be
//! left out of the score, which the publication does not do. Source: book, Floor and dirt: Published dirt detector
//! (Grünauer et al. 2017, by Yan et al. 2020a).

use heapless::Vec;

use super::blocks::{BlockGrid, DirtFault};
use super::mixture::{FitRules, Mixture, Point};
use super::order::median_and_spread;
use floorguard_types::capacities::FLOOR_BLOCKS_MAX;
use floorguard_types::sensing::ColorImage;

/// How to look for dirt.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PublishedParameters {
    /// Components of each channel's mixture, 1..=5.
    pub components: usize,
    /// How the mixtures are fitted.
    pub rules: FitRules,
    /// Components with a smaller weight do not explain anything; 0 is the publication.
    pub weight_min: f32,
    /// Standard deviations above the median that are dirt.
    pub deviations: f32,
    /// Below this mean gradient a block is smooth floor whatever the mixture says, Lab units a pixel.
    pub gradient_min: f32,
}

impl Default for PublishedParameters {
    fn default() -> Self {
        Self {
            components: 3,
            rules: FitRules::default(),
            weight_min: 0.0,
            deviations: 6.0,
            gradient_min: 2.0,
        }
    }
}

/// Fewest usable blocks, and fewest for a component (book, Floor and dirt: Published dirt detector).
const BLOCKS_MIN: usize = 60;
const BLOCKS_A_COMPONENT: usize = 20;

/// The detector and its working memory.
#[derive(Clone, Debug, Default)]
pub struct PublishedDetector {
    /// How to look.
    pub parameters: PublishedParameters,
    grid: BlockGrid,
    points: Vec<Point, FLOOR_BLOCKS_MAX>,
    scores: Vec<f32, FLOOR_BLOCKS_MAX>,
    dirty: Vec<bool, FLOOR_BLOCKS_MAX>,
}

impl PublishedDetector {
    /// Judges the blocks of an image.
    ///
    /// # Errors
    /// The image cannot be judged: its floor is unknown.
    pub fn detect(&mut self, image: &ColorImage<'_>, usable: &[bool]) -> Result<(), DirtFault> {
        self.scores.clear();
        self.dirty.clear();
        self.grid.measure(image, usable)?;
        let blocks = self.grid.blocks();
        let found = blocks.iter().filter(|block| block.is_usable).count();
        let needed = BLOCKS_MIN.max(BLOCKS_A_COMPONENT.saturating_mul(self.parameters.components));
        if found < needed {
            return Err(DirtFault::TooLittleFloor { found, needed });
        }
        for block in blocks {
            // Capacities are equal.
            let _ = self.scores.push(if block.is_usable { 0.0 } else { f32::NAN });
        }
        for channel in 0..3 {
            self.score_channel(channel);
        }
        self.judge();
        Ok(())
    }

    fn score_channel(&mut self, channel: usize) {
        let PublishedParameters { components, rules, weight_min, .. } = self.parameters;
        self.points.clear();
        for block in self.grid.blocks().iter().filter(|block| block.is_usable) {
            let _ = self.points.push(block.features.get(channel).copied().unwrap_or_default());
        }
        let start = Mixture::along_first_axis(&self.points, components, rules.variance_floor);
        let Some(mut mixture) = start else { return };
        mixture.fit(&self.points, &rules);
        let scorer = mixture.scorer(weight_min);
        for (score, block) in self.scores.iter_mut().zip(self.grid.blocks()) {
            if block.is_usable {
                *score -= scorer.log_likelihood(block.features.get(channel).copied().unwrap_or_default());
            }
        }
    }

    fn judge(&mut self) {
        let Some((median, spread)) = median_and_spread(self.scores.iter().copied()) else { return };
        let limit = median + self.parameters.deviations * spread;
        for (score, block) in self.scores.iter().zip(self.grid.blocks()) {
            let strongest = block.features.iter().map(|[mean, _]| *mean).fold(0.0, f32::max);
            let _ = self.dirty.push(*score > limit && strongest >= self.parameters.gradient_min);
        }
    }

    /// Blocks in a row of blocks.
    #[must_use]
    pub const fn columns(&self) -> usize {
        self.grid.columns()
    }

    /// The blocks that were judged.
    #[must_use]
    pub const fn grid(&self) -> &BlockGrid {
        &self.grid
    }

    /// How badly each block is explained; NaN where it was not judged.
    #[must_use]
    pub fn scores(&self) -> &[f32] {
        &self.scores
    }

    /// Which blocks are dirty. One that was not judged is not, but nor is it clean: its score is NaN.
    #[must_use]
    pub fn dirty(&self) -> &[bool] {
        &self.dirty
    }
}
