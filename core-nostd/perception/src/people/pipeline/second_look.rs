//! A second look at the same moment: detections in other rings of the lidar, brought to the same tracker.
//!
//! Source: book, People: Second look.

use super::context::{PeopleOutputOf, SweepContext};
use super::state::PeoplePipelineOf;
use crate::shapes::person_model::probability;
use crate::tracking::DetectionOf;
use floorguard_types::geometry::Point2;
use floorguard_types::profile::{List, Profile};
use floorguard_types::sensing::SweepOf;

/// A detection of the second look this near to one of the first is the same person, metres.
const SAME_M: f32 = 0.5;
/// Farther away than this both looks decide what it is and where, metres: nearer the first one has rings enough, and the
/// second, close about the horizon, may see a part of the body alone.
const BOTH_FROM_M: f32 = 6.0;
/// A look never says more than this for or against a person.
const CERTAIN: f32 = 1.0e-3;

impl<P: Profile> PeoplePipelineOf<P> {
    /// As [`Self::find_people_moving`], with what another pipeline has detected in other rings of the same revolution. A
    /// person seen by both is one detection, so the tracker counts one sighting; a person that only the second look sees is added.
    /// Costs detections × detections more.
    pub fn find_people_with_second_look(
        &mut self,
        sweep: &SweepOf<P>,
        context: &SweepContext,
        second: &[DetectionOf<P>],
        moving_at: impl Fn(Point2) -> Option<bool>,
    ) -> PeopleOutputOf<'_, P> {
        self.find_detections(sweep, context);
        self.join_second_look(second);
        for detection in self.detections.iter_mut() {
            detection.moving = moving_at(detection.position);
        }
        self.track(sweep, context);
        PeopleOutputOf { clusters: &self.clusters, tracks: self.tracker.tracks(), counters: self.counters }
    }

    /// Joins or appends each detection. When the list is full, the rest of the second look is dropped and counted.
    fn join_second_look(&mut self, second: &[DetectionOf<P>]) {
        let first = self.detections.len();
        for seen in second {
            let distance_m = |own: &DetectionOf<P>| own.position.distance(seen.position);
            let nearest = self.detections.iter_mut().take(first);
            let nearest = nearest.min_by(|a, b| distance_m(a).total_cmp(&distance_m(b)));
            match nearest.filter(|own| distance_m(own) < SAME_M) {
                Some(own) if own.distance_m > BOTH_FROM_M => join(own, seen),
                Some(_) => {}
                None => {
                    let is_full = self.detections.len() >= self.tracker.detections_max();
                    if is_full || self.detections.push(*seen).is_err() {
                        self.counters.dropped_candidates = self.counters.dropped_candidates.saturating_add(1);
                    }
                }
            }
        }
    }
}

/// The mean of what both looks say; returns of both speak for it.
fn join<P: Profile>(own: &mut DetectionOf<P>, other: &DetectionOf<P>) {
    own.likeness = probability(0.5 * (log_odds(own.likeness) + log_odds(other.likeness)));
    own.points = own.points.saturating_add(other.points);
    own.position = Point2::new(
        0.5 * (own.position.x_m + other.position.x_m),
        0.5 * (own.position.y_m + other.position.y_m),
    );
}

fn log_odds(likeness: f32) -> f32 {
    let likely = likeness.clamp(CERTAIN, 1.0 - CERTAIN);
    libm::logf(likely / (1.0 - likely))
}

#[cfg(test)]
#[path = "second_look_tests.rs"]
mod tests;
