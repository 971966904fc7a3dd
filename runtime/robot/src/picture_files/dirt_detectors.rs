//! The published detector of dirt and ours on the same pixels, with their memory on the heap.

use floorguard_mapping::seen_dirt::Scores;
use floorguard_perception::floor::dirt::{
    DirtFault, FloorView, NOVELTY_BIN, NoveltyDetector, PublishedDetector,
};
use floorguard_types::sensing::ColorImage;

use super::dirt_memory::NoveltyBuffers;

/// Pixels along a block of the published detector.
const BLOCK: usize = 16;

/// One detector's answer for the pixels of a frame; NaN where it has none.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct DirtAnswer {
    /// How dirty, pixel by pixel.
    pub scores: Vec<f32>,
    /// Which pixels the detector calls dirty.
    pub is_dirty: Vec<bool>,
}

/// Both detectors and their memory.
#[derive(Default)]
pub struct DirtDetectors {
    published: Box<PublishedDetector>,
    ours: Box<NoveltyDetector>,
    memory: NoveltyBuffers,
}

impl DirtDetectors {
    /// Forgets earlier frames, before pictures that do not belong to them.
    pub fn forget(&mut self) {
        self.ours.forget();
    }

    /// Both answers for a frame: the published detector's and ours. With a view, ours remembers earlier frames.
    ///
    /// # Errors
    /// The frame cannot be judged: its floor is unknown.
    pub fn judge(
        &mut self,
        image: &ColorImage<'_>,
        usable: &[bool],
        view: Option<&FloorView>,
    ) -> Result<[DirtAnswer; 2], DirtFault> {
        self.published.detect(image, usable)?;
        let (width, pixels) = (image.width(), image.pixels().len());
        let columns = self.published.columns();
        let of_block = |index: usize| {
            let (column, row) = (index % width / BLOCK, index / width / BLOCK);
            (column < columns).then_some(row * columns + column)
        };
        let lookup = |index: usize| of_block(index).and_then(|block| self.published.scores().get(block));
        let dirty = |index: usize| of_block(index).and_then(|block| self.published.dirty().get(block));
        let first = DirtAnswer {
            scores: (0..pixels).map(|index| lookup(index).copied().unwrap_or(f32::NAN)).collect(),
            is_dirty: (0..pixels).map(|index| dirty(index) == Some(&true)).collect(),
        };
        self.watch(image, usable, view)?;
        let (columns, rows) = (self.ours.columns(), self.ours.rows());
        let score = |index: usize| {
            let (column, row) = (index % width / NOVELTY_BIN, index / width / NOVELTY_BIN);
            if column < columns && row < rows {
                self.memory.scores()[row * columns + column]
            } else {
                f32::NAN
            }
        };
        let scores: Vec<f32> = (0..pixels).map(score).collect();
        let is_dirty = scores.iter().map(|score| *score > self.ours.threshold()).collect();
        Ok([first, DirtAnswer { scores, is_dirty }])
    }

    /// Only ours, whose answer is in [`Self::scores`].
    ///
    /// # Errors
    /// The frame cannot be judged: its floor is unknown.
    pub fn watch(
        &mut self,
        image: &ColorImage<'_>,
        usable: &[bool],
        view: Option<&FloorView>,
    ) -> Result<(), DirtFault> {
        self.memory.resize(image.pixels().len());
        self.ours.detect(image, usable, view, &mut self.memory.lend())
    }

    /// The last output of ours, for the map.
    #[must_use]
    pub fn scores(&self) -> Scores<'_> {
        let pixels = self.ours.columns() * self.ours.rows();
        let values = self.memory.scores().get(..pixels).unwrap_or(&[]);
        let colours = self.memory.colours().get(..pixels).unwrap_or(&[]);
        Scores { values, colours, columns: self.ours.columns(), threshold: self.ours.threshold() }
    }

    /// The published detector, after [`Self::judge`].
    #[must_use]
    pub fn published(&self) -> &PublishedDetector {
        &self.published
    }
}
