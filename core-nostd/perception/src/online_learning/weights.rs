//! The correction: weights of the waves, added to the log-odds of the shipped classifier.

use floorguard_types::number::nearest_f32;

use super::basis::{BASIS, Basis};
use crate::shapes::person_model::{person_log_odds, probability};
use crate::shapes::shape::ShapeVector;

/// The farthest a correction goes, in log-odds: what is certain stays so.
const CORRECTION_MAX: f32 = 4.0;
/// First step of the descent, divided by 1 + t / 1000. A step of 0.01 is usual, with which a hundred labelled tracks
/// move nothing; with 0.64 the last samples drown the others.
const STEP: f32 = 0.1;
/// Weights fall by this share of a step: what is not confirmed is forgotten.
const DECAY: f32 = 1.0e-3;

/// Weights. Zero is the shipped classifier.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Weights {
    /// Of each wave.
    pub waves: [f32; BASIS],
    /// For all shapes alike.
    pub offset: f32,
    /// Steps taken.
    pub steps: u32,
}

impl Weights {
    /// No correction.
    pub const ZERO: Self = Self { waves: [0.0; BASIS], offset: 0.0, steps: 0 };

    /// False for weights that no learning can have made.
    #[must_use]
    pub fn is_sound(&self) -> bool {
        let sound = |value: &f32| value.is_finite() && value.abs() < 1.0e3;
        self.waves.iter().all(sound) && sound(&self.offset)
    }

    fn correction(&self, waves: &[f32; BASIS]) -> f32 {
        let sum: f32 = self.waves.iter().zip(waves).map(|(weight, wave)| weight * wave).sum();
        (sum + self.offset).clamp(-CORRECTION_MAX, CORRECTION_MAX)
    }

    /// Corrected log-odds that a shape is a person.
    #[must_use]
    pub fn log_odds(&self, basis: &Basis, shape: &ShapeVector) -> f32 {
        person_log_odds(shape) + self.correction(&basis.at(shape))
    }

    /// One step towards the label of a shape; without a label towards what the shipped classifier says.
    pub(super) fn step(&mut self, basis: &Basis, shape: &ShapeVector, label: Option<bool>) {
        let waves = basis.at(shape);
        let shipped = person_log_odds(shape);
        let predicted = probability(shipped + self.correction(&waves));
        let wrong =
            label.map_or(probability(shipped), |is_person| f32::from(u8::from(is_person))) - predicted;
        let rate = STEP / (1.0 + nearest_f32(self.steps) * 1.0e-3);
        for (weight, wave) in self.waves.iter_mut().zip(waves) {
            *weight += rate * (wrong * wave - DECAY * *weight);
        }
        self.offset += 0.05 * rate * wrong;
        self.steps = self.steps.saturating_add(1);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::shapes::shape::SHAPE_FEATURES;

    #[test]
    fn steps_move_towards_labels_zero_is_shipped() {
        let basis = Basis::new([].iter());
        let shape = [0.4; SHAPE_FEATURES];
        let mut weights = Weights::ZERO;
        assert_eq!(weights.log_odds(&basis, &shape), person_log_odds(&shape));
        for label in [true, false] {
            let before = weights.log_odds(&basis, &shape);
            (0..50).for_each(|_| weights.step(&basis, &shape, Some(label)));
            let after = weights.log_odds(&basis, &shape);
            assert!(if label { after > before } else { after < before }, "{label}: {before} {after}");
        }
        assert!(weights.is_sound());
        weights.waves[3] = f32::NAN;
        assert!(!weights.is_sound());
    }
}
