//! Our detector: pixels that are rare on this floor by colour or texture, and stay so while the robot moves.
//!
//! Light falls off over an image, so everything is taken relative to the median of its wide surroundings. Three cues
//! are summed, each as a logarithm of rarity: the colour of a spot of millimetres, the colour of a spot of centimetres,
//! in which chips and grain average out, and texture that changes both ways, which gaps and planks do not. Gaps are
//! recognised by their shape and left out. Nothing is trained on dirt or on floors; the image itself is the reference.

use super::blocks::DirtFault;
use super::lab::LabTables;
use super::lines::{Bytes, FLOOR, LINE, NO_FLOOR, classify, eigenvalues, tensor};
use super::order::quantiles;
use super::pixels::{Pixel, box_mean, box_mean_of_first, halve, shrink};
use super::rarity::Rarity;
use super::recall::{FloorView, Remembered, recall, remember};
use super::surroundings::{CELL, Surroundings};
use crate::floor::root::{lesser, logarithm};
use floorguard_types::capacities::FLOOR_IMAGE_COLUMNS_MAX;
use floorguard_types::sensing::ColorImage;

/// Pixels of the image along one pixel of the result.
pub const NOVELTY_BIN: usize = 2;
/// Least spread of a colour, Lab units: half of what one just sees; and of the logarithm of texture.
const COLOUR_SPREAD_MIN: f32 = 0.3;
const TEXTURE_SPREAD_MIN: f32 = 0.1;
/// Texture below this is the camera's noise, squared Lab units a pixel.
const TEXTURE_MIN: f32 = 0.02;
/// Fewest usable pixels of the result: 60 blocks of 16 × 16 (book, Floor and dirt: Novelty).
const PIXELS_MIN: usize = 60 * 64;
/// Lightness 0..=100 of a pixel that tells a colour: above 14 of 255 and below 254.
const LIT: core::ops::Range<f32> = 4.0..99.6;
/// Every so manieth pixel says whether there is light.
const LIT_STEP: usize = 7;
/// Most of the floor that may be black or overexposed, percent: an unlit half is no reference for the other.
const UNLIT_MAX: usize = 50;
/// Part of the floor whose texture is usual, and what differences within it count: a floor of chips has all textures.
const USUAL: f32 = 0.8;
const USUAL_WEIGHT: f32 = 0.3;
/// Every so many pixels one says what is usual.
const USUAL_STEP: usize = 3;
/// Most by which a wide cue may exceed the fine one.
const BEYOND_FINE: f32 = 3.0;
/// From this sum of logarithms of rarity on it is dirt. Tuned on rendered floors of six kinds, where three of four
/// pixels called dirty are and two of three dirty ones are called; each of its units trades a twentieth of the one for
/// as much of the other.
const THRESHOLD: f32 = 21.0;

/// Working memory. What belongs to a pixel at half size needs a value for each, at quarter size a quarter of that.
pub struct NoveltyMemory<'a> {
    /// Colours at half size, and the same smoothed. Afterwards the first are relative to their surroundings, of weight 0
    /// where no floor is and in gaps.
    pub half: [&'a mut [Pixel]; 2],
    /// At quarter size.
    pub quarter: [&'a mut [Pixel]; 3],
    /// Bytes at half size.
    pub bytes: [&'a mut [u8]; 4],
    /// The result at half size: how rare each pixel is; NaN where it is no free floor.
    pub scores: &'a mut [f32],
    /// What is remembered from frame to frame at half size, and a buffer for the next. The caller keeps the
    /// first.
    pub remembered: [&'a mut [Remembered]; 2],
}

/// The detector and its fixed tables.
#[derive(Clone, Debug, Default)]
pub struct NoveltyDetector {
    tables: LabTables,
    surroundings: Surroundings,
    fine: Rarity,
    coarse: Rarity,
    texture: Rarity,
    columns: usize,
    rows: usize,
    remembered: Option<(FloorView, usize)>,
}

impl NoveltyDetector {
    /// Columns of the result: half of the image's.
    #[must_use]
    pub const fn columns(&self) -> usize {
        self.columns
    }

    /// Rows of the result: half of the image's.
    #[must_use]
    pub const fn rows(&self) -> usize {
        self.rows
    }

    /// A score above this is dirt.
    #[must_use]
    pub const fn threshold(&self) -> f32 {
        THRESHOLD
    }

    /// Forgets earlier frames: after a jump of the pose, a pause, or for pictures that do not belong together.
    pub fn forget(&mut self) {
        self.remembered = None;
    }

    /// Judges the pixels of an image. `usable` says of each pixel whether it is free floor. With a view, earlier frames
    /// of other viewpoints count too.
    ///
    /// # Errors
    /// The image cannot be judged: its floor is unknown.
    pub fn detect(
        &mut self,
        image: &ColorImage<'_>,
        usable: &[bool],
        view: Option<&FloorView>,
        memory: &mut NoveltyMemory<'_>,
    ) -> Result<(), DirtFault> {
        let pixels = self.measure(image, usable, memory)?;
        let small = (self.columns / 2).saturating_mul(self.rows / 2);
        let [colours, smooth] = &mut memory.half;
        let (colours, smooth) = (front(colours, pixels), front(smooth, pixels));
        let [first, second, cues] = &mut memory.quarter;
        let (first, second, cues) = (front(first, small), front(second, small), front(cues, small));
        let [class, light, one, two] = &mut memory.bytes;
        let (light, one, two) = (front(light, pixels), front(one, pixels), front(two, pixels));
        let mut bytes = Bytes { class: front(class, pixels), light, one, two };
        shrink(&self.tables, (image, usable), colours);
        let found = colours.iter().filter(|[.., weight]| *weight > 0.0).count();
        if found < PIXELS_MIN {
            return Err(DirtFault::TooLittleFloor { found: found / 64, needed: PIXELS_MIN / 64 });
        }
        let floor = colours.iter().step_by(LIT_STEP).filter(|[.., weight]| *weight > 0.0);
        let (unlit, seen) = floor.fold((0_usize, 0_usize), |(unlit, seen), [l, ..]| {
            (unlit.saturating_add(usize::from(!LIT.contains(l))), seen.saturating_add(1))
        });
        let unlit = unlit.saturating_mul(100) / seen.max(1);
        if unlit > UNLIT_MAX {
            return Err(DirtFault::Unlit(unlit));
        }
        tensor(colours, self.columns, smooth);
        halve(smooth, self.columns, first);
        box_mean::<5>(first, self.columns / 2, second);
        classify(colours, self.columns, second, &mut bytes);
        leave_out_lines(colours, bytes.class);
        tensor(colours, self.columns, smooth);
        halve(smooth, self.columns, first);
        box_mean::<5>(first, self.columns / 2, second);
        halve(colours, self.columns, first);
        self.score_texture(first, second, cues);
        self.surroundings.learn(first, (self.columns / 2, self.rows / 2), 3);
        box_mean::<5>(first, self.columns / 2, second);
        self.score_coarse(second, cues);
        box_mean::<3>(colours, self.columns, smooth);
        self.score_fine((smooth, bytes.class), cues);
        relate(&self.surroundings, colours, (self.columns, 2 * CELL));
        let scores = front(memory.scores, pixels);
        box_mean_of_first(smooth, self.columns, scores);
        for (score, class) in scores.iter_mut().zip(bytes.class.iter()) {
            // What is floor, but nobody knows how rare, is not dirty.
            let known = if score.is_nan() { 0.0 } else { *score };
            *score = if *class == NO_FLOOR { f32::NAN } else { known };
        }
        if let Some(view) = view {
            self.carry(view, scores, &mut memory.remembered);
        }
        Ok(())
    }

    /// Checks sizes; the number of pixels of the result. Both sides are cut to whole pixels of quarter size.
    fn measure(
        &mut self,
        image: &ColorImage<'_>,
        usable: &[bool],
        memory: &NoveltyMemory<'_>,
    ) -> Result<usize, DirtFault> {
        let (width, height) = (image.width(), image.height());
        if width > FLOOR_IMAGE_COLUMNS_MAX || height > FLOOR_IMAGE_COLUMNS_MAX {
            return Err(DirtFault::TooWide(width.max(height)));
        }
        if usable.len() != image.pixels().len() {
            return Err(DirtFault::WrongMask { values: usable.len(), pixels: image.pixels().len() });
        }
        self.columns = width / 2;
        self.rows = height / 2;
        let pixels = self.columns.saturating_mul(self.rows);
        let lengths = |slices: &[&mut [Pixel]]| slices.iter().map(|slice| slice.len()).min().unwrap_or(0);
        let bytes = memory.bytes.iter().map(|slice| slice.len()).min().unwrap_or(0);
        let remembered = memory.remembered.iter().map(|slice| slice.len()).min().unwrap_or(0);
        let capacity = lengths(&memory.half)
            .min(lengths(&memory.quarter).saturating_mul(4).saturating_add(3))
            .min(bytes)
            .min(memory.scores.len())
            .min(remembered);
        if capacity < pixels {
            Err(DirtFault::MemoryTooSmall { given: capacity, needed: pixels })
        } else {
            Ok(pixels)
        }
    }

    /// Texture that changes both ways, relative to its surroundings and beyond what is usual: the first of the cues.
    fn score_texture(&mut self, colours: &[Pixel], tensor: &mut [Pixel], cues: &mut [Pixel]) {
        for (texture, [.., weight]) in tensor.iter_mut().zip(colours) {
            let [_, along] = eigenvalues(*texture);
            *texture = [0.5 * logarithm(along + TEXTURE_MIN), 0.0, 0.0, *weight];
        }
        let columns = self.columns / 2;
        self.surroundings.learn(tensor, (columns, self.rows / 2), 1);
        relate(&self.surroundings, tensor, (columns, CELL));
        self.texture.learn(tensor, TEXTURE_SPREAD_MIN);
        for (cue, [value, ..]) in cues.iter_mut().zip(tensor.iter()) {
            *cue = [self.texture.of([*value, 0.0, 0.0]), 0.0, 0.0, 1.0];
        }
        let [usual] =
            quantiles(cues.iter().step_by(USUAL_STEP).map(|[value, ..]| *value), [USUAL]).unwrap_or([0.0]);
        for [value, ..] in cues.iter_mut() {
            let over = *value - usual;
            *value = if over > 0.0 { over } else { USUAL_WEIGHT * over };
        }
    }

    /// Colours of centimetres, relative to their surroundings: the second of the cues.
    fn score_coarse(&mut self, colours: &mut [Pixel], cues: &mut [Pixel]) {
        relate(&self.surroundings, colours, (self.columns / 2, CELL));
        self.coarse.learn(colours, COLOUR_SPREAD_MIN);
        for ([texture, coarse, _, weight], [l, a, b, _]) in cues.iter_mut().zip(colours.iter()) {
            *coarse = self.coarse.of([*l, *a, *b]);
            *weight = if (*texture + *coarse).is_nan() { 0.0 } else { 1.0 };
        }
    }

    /// Colours of millimetres, and the sum of all cues in their place. In a gap the coarse colour stands for the fine.
    fn score_fine(&mut self, (colours, class): (&mut [Pixel], &[u8]), cues: &[Pixel]) {
        for ([.., weight], class) in colours.iter_mut().zip(class) {
            *weight = if *class == FLOOR { 1.0 } else { 0.0 };
        }
        let columns = self.columns.max(1);
        relate(&self.surroundings, colours, (columns, 2 * CELL));
        self.fine.learn(colours, COLOUR_SPREAD_MIN);
        let cue_columns = (columns / 2).max(1);
        let last = (self.rows / 2).saturating_sub(1);
        let rows = colours.chunks_exact_mut(columns).zip(class.chunks_exact(columns));
        for (row, (colours, class)) in rows.enumerate() {
            let cues = cues.chunks_exact(cue_columns).nth((row / 2).min(last)).unwrap_or(&[]);
            let pairs = colours.chunks_mut(2).zip(class.chunks(2));
            for ((colours, class), cue) in pairs.zip(cues.iter().chain(cues.last())) {
                let [texture, coarse, _, weight] = *cue;
                for (colour, class) in colours.iter_mut().zip(class) {
                    let [l, a, b, _] = *colour;
                    let fine = if *class == FLOOR { self.fine.of([l, a, b]) } else { coarse };
                    // Wide cues reach beyond the edge of a spot; where the fine one sees nothing they count little.
                    let most = fine + BEYOND_FINE;
                    let sum = fine + lesser(coarse, most) + lesser(texture, most);
                    let is_known = *class != NO_FLOOR && weight > 0.0 && !fine.is_nan();
                    *colour = if is_known { [sum, 0.0, 0.0, 1.0] } else { [0.0; 4] };
                }
            }
        }
    }

    /// Averages with earlier frames; remembers this one if it is from elsewhere.
    fn carry(&mut self, view: &FloorView, scores: &mut [f32], remembered: &mut [&mut [Remembered]; 2]) {
        let [past, next] = remembered;
        let (past, next) = (front(past, scores.len()), front(next, scores.len()));
        let before = self.remembered.filter(|(_, pixels)| *pixels == scores.len());
        match before {
            Some((before, _)) => recall((view, &before), self.columns, scores, (past, next)),
            None => remember(scores, next),
        }
        if before.is_none_or(|(before, _)| view.is_elsewhere(&before)) {
            past.iter_mut().zip(next.iter()).for_each(|(past, next)| *past = *next);
            self.remembered = Some((*view, scores.len()));
        }
    }
}

/// The first values of a slice.
fn front<T>(values: &mut [T], count: usize) -> &mut [T] {
    let count = count.min(values.len());
    values.split_at_mut(count).0
}

/// Takes gaps out of the colours.
fn leave_out_lines(colours: &mut [Pixel], class: &[u8]) {
    for ([.., weight], class) in colours.iter_mut().zip(class) {
        if *class == LINE {
            *weight = 0.0;
        }
    }
}

/// Values minus their surroundings.
fn relate(surroundings: &Surroundings, pixels: &mut [Pixel], (columns, cell): (usize, usize)) {
    for (row, pixels) in pixels.chunks_exact_mut(columns.max(1)).enumerate() {
        surroundings.line(row, cell).subtract(pixels);
    }
}
