//! What was learnt, as a belief about each track: beside the tracker's own, which stays what it is.
//!
//! The tracker goes on with the shipped classifier, so that its tracks are the same with and without learning. Here the
//! same evidence is added up once more with the corrected scores in place of the shipped ones.

use heapless::Vec;

use crate::shapes::person_model::probability;
use crate::tracking::{BELIEF_MAX, PeopleSensor, SHAPE_EVIDENCE_MAX, Track};
use floorguard_types::capacities::LEARNING_TRACKS;

/// The log-odds of one observation of a track.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ShapeScores {
    /// By the shipped classifier.
    pub shipped: f32,
    /// By what is in use.
    pub learned: f32,
}

#[derive(Clone, Copy, Debug)]
struct Belief {
    track: u32,
    /// The tracker's, when it was last entered.
    shipped: f32,
    learned: f32,
    is_there: bool,
}

/// Beliefs about all tracks.
#[derive(Clone, Debug, Default)]
pub struct LearnedBeliefs {
    beliefs: Vec<Belief, LEARNING_TRACKS>,
}

impl LearnedBeliefs {
    /// Nothing is known of anybody.
    #[must_use]
    pub const fn new() -> Self {
        Self { beliefs: Vec::new() }
    }

    /// Takes in all tracks of a sweep, each with its look if there was one. Tracks that are not among them are forgotten.
    pub fn update<'a>(&mut self, tracks: impl Iterator<Item = (&'a Track, Option<ShapeScores>)>) {
        for belief in &mut self.beliefs {
            belief.is_there = false;
        }
        for (track, scores) in tracks.take(LEARNING_TRACKS) {
            let now = log_odds(track.person_probability);
            let scores = scores.unwrap_or(ShapeScores { shipped: 0.0, learned: 0.0 });
            match self.beliefs.iter_mut().find(|belief| belief.track == track.id) {
                Some(belief) => belief.follow(now, scores),
                None => {
                    let share = scores.learned.clamp(-SHAPE_EVIDENCE_MAX, SHAPE_EVIDENCE_MAX)
                        - scores.shipped.clamp(-SHAPE_EVIDENCE_MAX, SHAPE_EVIDENCE_MAX);
                    let learned = (now + share).clamp(-BELIEF_MAX, BELIEF_MAX);
                    // Beyond the capacity only the tracker's belief is kept.
                    let _ =
                        self.beliefs.push(Belief { track: track.id, shipped: now, learned, is_there: true });
                }
            }
        }
        self.beliefs.retain(|belief| belief.is_there);
    }

    /// Probability that a track is a person; `None` if it is not known.
    #[must_use]
    pub fn probability(&self, track: u32) -> Option<f32> {
        self.beliefs.iter().find(|belief| belief.track == track).map(|belief| probability(belief.learned))
    }
}

impl Belief {
    fn follow(&mut self, now: f32, scores: ShapeScores) {
        let share = PeopleSensor::Lidar.evidence_weight();
        let (shipped, learned) = (
            share * scores.shipped.clamp(-SHAPE_EVIDENCE_MAX, SHAPE_EVIDENCE_MAX),
            share * scores.learned.clamp(-SHAPE_EVIDENCE_MAX, SHAPE_EVIDENCE_MAX),
        );
        // A firm belief does not show what else was added to it: motion, legs, cameras.
        let is_firm = now.abs() > BELIEF_MAX - 1.0e-2;
        let others = if is_firm { 0.0 } else { now - self.shipped - shipped };
        self.learned = (self.learned + learned + others).clamp(-BELIEF_MAX, BELIEF_MAX);
        (self.shipped, self.is_there) = (now, true);
    }
}

fn log_odds(probability: f32) -> f32 {
    let probability = probability.clamp(1.0e-3, 1.0 - 1.0e-3);
    libm::logf(probability / (1.0 - probability)).clamp(-BELIEF_MAX, BELIEF_MAX)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::tracking::{Appearance, Detection, Tracker, TrackerParameters};
    use floorguard_types::geometry::Point2;
    use floorguard_types::time::Stamp;

    /// A person stands there for `sweeps` sweeps with the score `shipped`; gives the tracker's probability and
    /// ours.
    fn stand(shipped: f32, learned: f32, sweeps: u64) -> [f32; 2] {
        let mut tracker = std::boxed::Box::new(Tracker::new(TrackerParameters::DEFAULT));
        let mut beliefs = LearnedBeliefs::new();
        let position = Point2::new(4.0, 0.0);
        let likeness = probability(shipped);
        for sweep in 1..=sweeps {
            let sighting = Detection {
                position,
                distance_m: 4.0,
                sigma_m: 0.1,
                likeness,
                points: 50,
                moving: None,
                surroundings: crate::tracking::Surroundings::OPEN,
                appearance: Appearance::UNKNOWN,
            };
            tracker.update(Stamp::from_micros(sweep * 100_000), &[sighting], |_| true);
            beliefs
                .update(tracker.tracks().iter().map(|track| (track, Some(ShapeScores { shipped, learned }))));
        }
        let track = &tracker.tracks()[0];
        [track.person_probability, beliefs.probability(track.id).unwrap()]
    }

    #[test]
    fn without_a_correction_it_is_the_trackers_belief() {
        for shipped in [-1.5, -0.3, 0.4, 1.8] {
            for sweeps in [1, 5, 60] {
                let [own, ours] = stand(shipped, shipped, sweeps);
                assert!((own - ours).abs() < 2.0e-3, "{shipped} {sweeps}: {own} {ours}");
            }
        }
    }

    #[test]
    fn corrected_shape_flips_belief_forgotten_track_unknown() {
        let [own, ours] = stand(1.0, -1.0, 30);
        assert!(own > 0.9 && ours < 0.1, "{own} {ours}");
        let [own, ours] = stand(-1.0, 1.0, 30);
        assert!(own < 0.1 && ours > 0.9, "{own} {ours}");
        assert_eq!(LearnedBeliefs::new().probability(1), None);
    }
}
