//! Where one person was, at even times, and the predictions that wait for their outcome.

use floorguard_types::geometry::Point2;
use floorguard_types::number::nearest_f32;
use heapless::Vec;

use super::STEPS;
use super::motion_model::Rows;

/// Steps that a prediction looks back on.
pub const SEEN_STEPS: usize = 8;
/// Predictions of one person that wait for their outcome.
const PENDING_MAX: usize = 4;

/// A prediction and what came of it so far.
#[derive(Clone, Debug)]
pub(super) struct Pending {
    pub(super) rows: Rows,
    pub(super) from: Point2,
    pub(super) outcome: Vec<Point2, STEPS>,
}

/// One person: the caller keeps one beside each track.
#[derive(Clone, Debug, Default)]
pub struct PersonTrail {
    places: Vec<Point2, SEEN_STEPS>,
    pub(super) pending: Vec<Pending, PENDING_MAX>,
    pub(super) since_pending: u32,
}

impl PersonTrail {
    /// The next place; the oldest is forgotten.
    pub(super) fn push(&mut self, place: Point2) {
        if self.places.is_full() {
            self.places.remove(0);
        }
        // It fits now.
        let _ = self.places.push(place);
    }

    /// The person was not seen for a step: nothing before counts.
    pub fn interrupt(&mut self) {
        *self = Self::default();
    }

    /// Places, oldest first.
    #[must_use]
    pub fn places(&self) -> &[Point2] {
        &self.places
    }

    /// The step that ended `back` steps ago, metres.
    pub(super) fn step(&self, back: usize) -> Option<Point2> {
        let last = self.places.len().checked_sub(back.checked_add(1)?)?;
        let (to, from) = (self.places.get(last)?, self.places.get(last.checked_sub(1)?)?);
        Some(Point2::new(to.x_m - from.x_m, to.y_m - from.y_m))
    }

    /// Deviation of all steps from their mean, metres.
    pub(super) fn unsteadiness_m(&self) -> f32 {
        let count = nearest_f32(self.places.len().saturating_sub(1).max(1));
        let steps = || (0..SEEN_STEPS).filter_map(|back| self.step(back));
        let sum =
            steps().fold(Point2::default(), |sum, step| Point2::new(sum.x_m + step.x_m, sum.y_m + step.y_m));
        let mean = Point2::new(sum.x_m / count, sum.y_m / count);
        let squares: f32 = steps().map(|step| step.distance(mean) * step.distance(mean)).sum();
        libm::sqrtf(squares / count)
    }
}
