//! Memory on the heap for the detector of dirt, which has none of its own.

use floorguard_perception::floor::dirt::{NOVELTY_BIN, NoveltyMemory, Pixel, Remembered};

/// What [`NoveltyMemory`] lends.
#[derive(Clone, Debug, Default)]
pub struct NoveltyBuffers {
    half: [Vec<Pixel>; 2],
    quarter: [Vec<Pixel>; 3],
    bytes: [Vec<u8>; 4],
    scores: Vec<f32>,
    remembered: [Vec<Remembered>; 2],
}

impl NoveltyBuffers {
    /// Capacity for images of this many pixels.
    pub fn resize(&mut self, image_pixels: usize) {
        let half = image_pixels.div_ceil(NOVELTY_BIN * NOVELTY_BIN);
        self.half.iter_mut().for_each(|values| values.resize(half, [0.0; 4]));
        self.quarter.iter_mut().for_each(|values| values.resize(half.div_ceil(4), [0.0; 4]));
        self.bytes.iter_mut().for_each(|values| values.resize(half, 0));
        self.scores.resize(half, f32::NAN);
        self.remembered.iter_mut().for_each(|values| values.resize(half, [0.0; 2]));
    }

    /// Lends it to one call.
    pub fn lend(&mut self) -> NoveltyMemory<'_> {
        NoveltyMemory {
            half: self.half.each_mut().map(Vec::as_mut_slice),
            quarter: self.quarter.each_mut().map(Vec::as_mut_slice),
            bytes: self.bytes.each_mut().map(Vec::as_mut_slice),
            scores: &mut self.scores,
            remembered: self.remembered.each_mut().map(Vec::as_mut_slice),
        }
    }

    /// The colours of the last image relative to their surroundings, at half size.
    #[must_use]
    pub fn colours(&self) -> &[Pixel] {
        let [colours, _] = &self.half;
        colours
    }

    /// The scores of the last image, at half size.
    #[must_use]
    pub fn scores(&self) -> &[f32] {
        &self.scores
    }
}
