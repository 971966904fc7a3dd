//! What the experts labelled, in fixed memory: an even choice of everything so far, each class with its own.

use heapless::Vec;

use crate::shapes::shape::ShapeVector;
use floorguard_types::capacities::{LEARNING_HELD_OUT, LEARNING_SAMPLES};
use floorguard_types::number::exact_usize;
use floorguard_types::random::Pcg32;

/// A shape and what it is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LabelledShape {
    /// The shape.
    pub shape: ShapeVector,
    /// Whether it is a person.
    pub is_person: bool,
}

/// One track of a class in this many is held out with all its shapes: shapes of one track resemble each other.
const HELD_OUT_EVERY: u32 = 4;

/// An even choice of a stream.
#[derive(Clone, Debug)]
struct Reservoir<const CAPACITY: usize> {
    kept: Vec<ShapeVector, CAPACITY>,
    seen: u32,
}

impl<const CAPACITY: usize> Reservoir<CAPACITY> {
    const fn new() -> Self {
        Self { kept: Vec::new(), seen: 0 }
    }

    fn add(&mut self, shape: &ShapeVector, random: &mut Pcg32) {
        self.seen = self.seen.saturating_add(1);
        if self.kept.push(*shape).is_err()
            && let Some(slot) = self.kept.get_mut(exact_usize(random.below(self.seen)))
        {
            *slot = *shape;
        }
    }
}

/// Samples to learn from and samples to judge by; index 0 is nobody, 1 a person.
#[derive(Clone, Debug)]
pub struct SampleStore {
    training: [Reservoir<LEARNING_SAMPLES>; 2],
    held_out: [Reservoir<LEARNING_HELD_OUT>; 2],
    tracks: [u32; 2],
}

impl SampleStore {
    /// Empty.
    #[must_use]
    pub const fn new() -> Self {
        Self {
            training: [Reservoir::new(), Reservoir::new()],
            held_out: [Reservoir::new(), Reservoir::new()],
            tracks: [0; 2],
        }
    }

    /// Adds the shapes of a track.
    pub(super) fn add<'a>(
        &mut self,
        is_person: bool,
        shapes: impl Iterator<Item = &'a ShapeVector>,
        random: &mut Pcg32,
    ) {
        let class = usize::from(is_person);
        let (Some(tracks), Some(training), Some(held_out)) =
            (self.tracks.get_mut(class), self.training.get_mut(class), self.held_out.get_mut(class))
        else {
            return;
        };
        *tracks = tracks.saturating_add(1);
        let is_held_out = tracks.is_multiple_of(HELD_OUT_EVERY);
        for shape in shapes {
            if is_held_out {
                held_out.add(shape, random);
            } else {
                training.add(shape, random);
            }
        }
    }

    /// One sample of a class to learn from; `None` without any.
    pub(super) fn draw(&self, is_person: bool, random: &mut Pcg32) -> Option<&ShapeVector> {
        let kept = &self.training.get(usize::from(is_person))?.kept;
        let count = u32::try_from(kept.len()).ok().filter(|count| *count > 0)?;
        kept.get(exact_usize(random.below(count)))
    }

    /// Held-out samples of a class.
    pub(super) fn held_out(&self, is_person: bool) -> &[ShapeVector] {
        self.held_out.get(usize::from(is_person)).map_or(&[], |reservoir| reservoir.kept.as_slice())
    }

    /// Samples to learn from: of nobody and of people.
    #[must_use]
    pub fn counts(&self) -> [usize; 2] {
        self.training.each_ref().map(|reservoir| reservoir.kept.len())
    }

    /// Held-out samples: of nobody and of people.
    #[must_use]
    pub fn held_out_counts(&self) -> [usize; 2] {
        self.held_out.each_ref().map(|reservoir| reservoir.kept.len())
    }
}

impl Default for SampleStore {
    fn default() -> Self {
        Self::new()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::shapes::shape::SHAPE_FEATURES;

    #[test]
    fn every_fourth_track_is_held_out() {
        let (mut store, mut random) = (std::boxed::Box::new(SampleStore::new()), Pcg32::new(1, 1));
        for track in 0..4_000_u32 {
            let shapes = [[track as f32; SHAPE_FEATURES]; 2];
            store.add(true, shapes.iter(), &mut random);
        }
        assert_eq!(store.counts(), [0, LEARNING_SAMPLES]);
        assert_eq!(store.held_out_counts(), [0, LEARNING_HELD_OUT]);
        assert!(store.held_out(true).iter().all(|shape| shape[0] as u32 % 4 == 3));
        let mean: f32 =
            (0..2_000).filter_map(|_| store.draw(true, &mut random).map(|shape| shape[0])).sum::<f32>()
                / 2_000.0;
        assert!((mean - 2_000.0).abs() < 250.0, "{mean}");
        assert!(store.draw(false, &mut random).is_none());
    }
}
