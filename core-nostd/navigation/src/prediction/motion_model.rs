//! How far people keep their speed and their turns in this place: seven numbers, learnt as outcomes arrive.
//!
//! The place after t (a share of the horizon) is a sum of vectors that turn with the person: the last step, the step before, the
//! last step times the unsteadiness, each times t and t², and the bend of the place. The numbers minimise the mean distance
//! (least squares, each outcome weighted by one over its error), beginning from constant velocity that fades a little.

use floorguard_types::geometry::Point2;
use floorguard_types::number::{nearest_f32, nearest_f32_of_f64, nearest_f64};

use super::STEPS;
use super::place_flow::{FlowCell, PlaceFlow};
use super::trail::PersonTrail;

/// Numbers of the model.
pub const FEATURES: usize = 7;
/// Constant velocity: 12 steps at the end of the horizon, 0.7 of them lost on the way.
const PRIOR: [f64; FEATURES] = [12.0, -0.7, 0.0, 0.0, 0.0, 0.0, 0.0];
/// The prior counts like so many outcomes.
const PRIOR_OUTCOMES: f64 = 15.0;
/// Sizes of the vectors for which it counts so, metres.
const PRIOR_SIZES_M: [f64; FEATURES] = [0.5, 0.5, 0.2, 0.2, 0.1, 0.1, 0.3];
/// Errors below this weigh as much as this, metres.
const ERROR_MIN_M: f64 = 0.1;

/// The vectors of one prediction; the bend differs from step to step.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Rows {
    pub(super) last: Point2,
    before: Point2,
    unsteady: Point2,
    bends: [Point2; STEPS],
}

impl Rows {
    /// Of a person seen for at least three steps.
    pub(super) fn of<S>(trail: &PersonTrail, flow: &PlaceFlow<S>) -> Option<Self>
    where
        S: AsRef<[FlowCell]> + AsMut<[FlowCell]>,
    {
        let (last, before) = (trail.step(0)?, trail.step(1)?);
        let unsteadiness_m = trail.unsteadiness_m();
        let share = unsteadiness_m / (unsteadiness_m + last.norm() + 0.02);
        let from = *trail.places().last()?;
        let (mut place, mut step) = (from, last);
        let bends = core::array::from_fn(|index| {
            step = flow.bend(place, step);
            place = Point2::new(place.x_m + step.x_m, place.y_m + step.y_m);
            let steps = nearest_f32(index) + 1.0;
            Point2::new(place.x_m - from.x_m - last.x_m * steps, place.y_m - from.y_m - last.y_m * steps)
        });
        Some(Self { last, before, unsteady: Point2::new(last.x_m * share, last.y_m * share), bends })
    }

    /// The vectors of one step, in the order of the numbers.
    fn at(&self, step: usize) -> [Point2; FEATURES] {
        let t = (nearest_f32(step) + 1.0) / nearest_f32(STEPS);
        let times = |vector: Point2, by: f32| Point2::new(vector.x_m * by, vector.y_m * by);
        [
            times(self.last, t),
            times(self.last, t * t),
            times(self.before, t),
            times(self.before, t * t),
            times(self.unsteady, t),
            times(self.unsteady, t * t),
            self.bends.get(step).copied().unwrap_or_default(),
        ]
    }
}

/// The numbers, and what they were learnt from.
#[derive(Clone, Debug)]
pub struct MotionModel {
    numbers: [f64; FEATURES],
    normal: [[f64; FEATURES]; FEATURES],
    right: [f64; FEATURES],
}

impl Default for MotionModel {
    fn default() -> Self {
        let mut model = Self { numbers: PRIOR, normal: [[0.0; FEATURES]; FEATURES], right: [0.0; FEATURES] };
        let each = model.normal.iter_mut().enumerate().zip(model.right.iter_mut());
        for (((index, row), right), (size_m, prior)) in each.zip(PRIOR_SIZES_M.into_iter().zip(PRIOR)) {
            if let Some(entry) = row.get_mut(index) {
                // Σ t² over the steps is about a third of them.
                *entry = PRIOR_OUTCOMES * size_m * size_m * nearest_f64(STEPS) / 3.0;
                *right = *entry * prior;
            }
        }
        model
    }
}

impl MotionModel {
    /// The numbers as they are now.
    #[must_use]
    pub const fn numbers(&self) -> &[f64; FEATURES] {
        &self.numbers
    }

    /// From where the person is to where they will be after a step of the horizon, metres.
    pub(super) fn travel(&self, rows: &Rows, step: usize) -> Point2 {
        let mut travel = Point2::default();
        for (vector, number) in rows.at(step).into_iter().zip(self.numbers) {
            travel.x_m += vector.x_m * nearest_f32_of_f64(number);
            travel.y_m += vector.y_m * nearest_f32_of_f64(number);
        }
        travel
    }

    /// Takes in the way that a person really went up to a step.
    pub(super) fn learn(&mut self, rows: &Rows, step: usize, travel: Point2) {
        let error_m = f64::from(self.travel(rows, step).distance(travel));
        if !error_m.is_finite() {
            return;
        }
        let weight = 0.5 / error_m.max(ERROR_MIN_M);
        let vectors = rows.at(step);
        let dot =
            |a: Point2, b: Point2| f64::from(a.x_m) * f64::from(b.x_m) + f64::from(a.y_m) * f64::from(b.y_m);
        for ((row, right), a) in self.normal.iter_mut().zip(&mut self.right).zip(vectors) {
            for (entry, b) in row.iter_mut().zip(vectors) {
                *entry += weight * dot(a, b);
            }
            *right += weight * dot(a, travel);
        }
    }

    /// Finds the numbers anew: Cholesky's decomposition of the normal equations. They stay as they are where it has no root.
    pub fn solve(&mut self) {
        let mut lower = [[0.0_f64; FEATURES]; FEATURES];
        let get = |matrix: &[[f64; FEATURES]; FEATURES], i: usize, j: usize| {
            matrix.get(i).and_then(|row| row.get(j)).copied().unwrap_or(0.0)
        };
        for i in 0..FEATURES {
            for j in 0..=i.min(FEATURES) {
                let mut sum = get(&self.normal, i, j);
                for k in 0..j.min(FEATURES) {
                    sum -= get(&lower, i, k) * get(&lower, j, k);
                }
                let value = if i == j { libm::sqrt(sum) } else { sum / get(&lower, j, j) };
                if !value.is_finite() || (i == j && value <= 0.0) {
                    return;
                }
                if let Some(entry) = lower.get_mut(i).and_then(|row| row.get_mut(j)) {
                    *entry = value;
                }
            }
        }
        let mut half = self.right;
        for i in 0..FEATURES {
            let known: f64 =
                (0..i.min(FEATURES)).map(|k| get(&lower, i, k) * half.get(k).copied().unwrap_or(0.0)).sum();
            if let Some(entry) = half.get_mut(i) {
                *entry = (*entry - known) / get(&lower, i, i);
            }
        }
        let mut numbers = half;
        for i in (0..FEATURES).rev() {
            let later = i.saturating_add(1)..FEATURES;
            let known: f64 = later.map(|k| get(&lower, k, i) * numbers.get(k).copied().unwrap_or(0.0)).sum();
            if let Some(entry) = numbers.get_mut(i) {
                *entry = (*entry - known) / get(&lower, i, i);
            }
        }
        if numbers.iter().all(|number| number.is_finite()) {
            self.numbers = numbers;
        }
    }
}
