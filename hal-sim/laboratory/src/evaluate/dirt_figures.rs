//! How well a detector of dirt did: pixels and blocks against the truth, summed over frames.

use serde::Serialize;

use super::roc::{area_under_curve, best_overlap};
use floorguard_robot::picture_files::DirtAnswer;

/// Pixels along a block.
const BLOCK: usize = 16;
/// Part of a block that is dirty where the block is: five pixels of 256.
const BLOCK_DIRTY: f64 = 0.02;

/// How well a detector tells dirt from floor. Overlap and areas are means over the frames with dirt; precision and
/// recall count the pixels of all frames. An undefined figure, such as the recall where no dirt is, is NaN (`null`).
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct DirtFigures {
    /// Intersection over union of pixels at the best threshold of each frame.
    pub best_iou: f64,
    /// Area under the curve of hits over false alarms, pixels.
    pub auc: f64,
    /// The same of blocks of 16 × 16 pixels.
    pub block_auc: f64,
    /// Intersection over union of pixels at the detector's own threshold, over all frames.
    pub iou: f64,
    /// Pixels called dirty that are, at the detector's own threshold.
    pub precision: f64,
    /// Dirty pixels called so, at the detector's own threshold.
    pub recall: f64,
}

/// Sums over frames.
#[derive(Clone, Debug, Default)]
pub struct DirtTotals {
    overlap: f64,
    area: f64,
    block_area: f64,
    dirty_frames: u32,
    hits: u64,
    called: u64,
    dirty: u64,
}

impl DirtTotals {
    /// Adds a frame: the answer, where dirt is, and which pixels count.
    pub fn add(&mut self, answer: &DirtAnswer, (truth, judged): (&[bool], &[bool]), width: usize) {
        let pixels = || answer.scores.iter().zip(truth).zip(judged).filter(|(_, is_judged)| **is_judged);
        let mut pairs: Vec<(f32, bool)> = pixels().map(|((score, truth), _)| (*score, *truth)).collect();
        if pairs.iter().any(|(_, is_dirt)| *is_dirt) {
            self.dirty_frames += 1;
            self.overlap += best_overlap(&mut pairs);
            self.area += area_under_curve(&mut pairs);
            self.block_area += area_under_curve(&mut block_pairs(answer, (truth, judged), width));
        }
        for ((is_called, is_true), is_judged) in answer.is_dirty.iter().zip(truth).zip(judged) {
            self.hits += u64::from(*is_called && *is_true && *is_judged);
            self.called += u64::from(*is_called && *is_judged);
            self.dirty += u64::from(*is_true && *is_judged);
        }
    }

    /// Some frame had dirt.
    #[must_use]
    pub const fn has_dirt(&self) -> bool {
        self.dirty > 0
    }

    /// The figures so far.
    #[must_use]
    pub fn figures(&self) -> DirtFigures {
        let frames = f64::from(self.dirty_frames);
        // Who calls nothing dirty where dirt is finds none of it; where none is, nobody can tell.
        let part = |of: u64| if of == 0 && self.has_dirt() { 0.0 } else { self.hits as f64 / of as f64 };
        DirtFigures {
            best_iou: self.overlap / frames,
            auc: self.area / frames,
            block_auc: self.block_area / frames,
            iou: part(self.called + self.dirty - self.hits),
            precision: part(self.called),
            recall: part(self.dirty),
        }
    }
}

/// Score and truth of every whole block: the mean of the highest sixteenth of its pixels, so that a detector of pixels
/// is not punished for being finer than a block.
fn block_pairs(answer: &DirtAnswer, (truth, judged): (&[bool], &[bool]), width: usize) -> Vec<(f32, bool)> {
    let (columns, rows) = (width / BLOCK, truth.len() / width.max(1) / BLOCK);
    let mut pairs = Vec::with_capacity(columns * rows);
    for block in 0..columns * rows {
        let (left, top) = (block % columns * BLOCK, block / columns * BLOCK);
        let places = (0..BLOCK * BLOCK).map(|i| (top + i / BLOCK) * width + left + i % BLOCK);
        let (mut scores, mut dirty) = (Vec::new(), 0_usize);
        for place in places.filter(|place| judged[*place]) {
            scores.push(answer.scores[place]);
            dirty += usize::from(truth[place]);
        }
        if scores.len() < BLOCK * BLOCK / 2 {
            continue;
        }
        scores.sort_by(|a, b| b.total_cmp(a));
        let share = dirty as f64 / scores.len() as f64;
        scores.truncate(BLOCK);
        pairs.push((scores.iter().sum::<f32>() / scores.len() as f32, share > BLOCK_DIRTY));
    }
    pairs
}
