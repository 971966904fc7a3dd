//! The learner beside the people stages: after each sweep it reads the tracks, learns a little, and gives its belief
//! about each.
//!
//! Everything follows from the sweeps and their stamps, so a recording with the same start gives the same bits.

use floorguard_perception::online_learning::{
    ExpertRules, LabelledShape, LearnedBeliefs, OnlineLearner, ShapeScores, Sight, Weights,
};
use floorguard_perception::people::person_model::person_log_odds;
use floorguard_perception::people::{PeoplePipeline, Track};
use floorguard_types::geometry::Point2;
use floorguard_types::time::{Age, Stamp};

use super::learning_slot::LearningSlot;
use super::report::LearningReport;

/// A detection this near to its track's place is its own, metres.
const OWN_M: f32 = 0.4;
/// Steps of learning after one sweep, at most: half a millisecond.
const STEPS_MAX: u64 = 100;
/// A pause of the lidar longer than this is no time to learn in, µs.
const PAUSE_US: u64 = 1_000_000;

/// Learns what people look like.
pub struct PeopleLearner {
    learner: Box<OnlineLearner>,
    beliefs: LearnedBeliefs,
    resumed: bool,
    corrects: bool,
    pace: Pace,
    shapes_scored: [u64; 2],
    slot: LearningSlot,
}

impl PeopleLearner {
    /// Begins with weights that were learned before; ones that do worse on the anchors than none are left aside (see
    /// [`Self::is_resumed`]). `update_us`: from one judgement to the next, at least.
    #[must_use]
    pub fn new(anchors: &[LabelledShape], start: &Weights, (update_us, slot): (u64, LearningSlot)) -> Self {
        let mut learner = Box::new(OnlineLearner::new(anchors, ExpertRules::DEFAULT));
        let corrects = *start != Weights::ZERO && learner.resume(start);
        Self {
            learner,
            beliefs: LearnedBeliefs::new(),
            resumed: corrects,
            corrects,
            pace: Pace { update_us: update_us.max(1), last: None, due: 0 },
            shapes_scored: [0; 2],
            slot,
        }
    }

    /// The weights of the start are in use.
    #[must_use]
    pub const fn is_resumed(&self) -> bool {
        self.resumed
    }

    /// Takes in a sweep that went through the people stages.
    pub fn observe(&mut self, people: &PeoplePipeline, stamp: Stamp) {
        let Self { learner, beliefs, shapes_scored, corrects, .. } = self;
        let own = |track: &Track| {
            let is_seen = track.last_seen == stamp;
            own_detection(people, track.state.position)
                .filter(|_| is_seen)
                .and_then(|index| people.shape(index))
        };
        if *corrects {
            beliefs.update(people.tracks().iter().map(|track| {
                let both = own(track).map(|shape| ShapeScores {
                    shipped: person_log_odds(shape),
                    learned: learner.log_odds(shape),
                });
                shapes_scored[1] +=
                    u64::from(both.is_some_and(|both| (both.shipped > 0.0) != (both.learned > 0.0)));
                (track, both)
            }));
        }
        let seen = people.tracks().iter().filter(|track| track.last_seen == stamp);
        let sights = seen.map(|track| {
            let shape = own(track);
            shapes_scored[0] += u64::from(shape.is_some());
            Sight { track: track.id, position: track.state.position, shape }
        });
        learner.observe(stamp, sights);
        self.learn(stamp);
        self.slot
            .put(LearningReport::of(&self.learner, self.resumed, self.shapes_scored), self.learner.weights());
    }

    /// As many steps as are due: one judgement in `update_us`.
    fn learn(&mut self, stamp: Stamp) {
        let steps = self.pace.steps(stamp);
        let before = self.learner.counters().accepted;
        self.learner.learn(steps);
        self.corrects |= self.learner.counters().accepted != before;
    }

    /// Probability that a track is a person, by what was learned; `None` while that is nothing.
    #[must_use]
    pub fn probability(&self, track: &Track) -> Option<f32> {
        self.beliefs.probability(track.id).filter(|_| self.corrects)
    }
}

/// The detection that was given to a track at a place: the nearest.
#[must_use]
pub fn own_detection(people: &PeoplePipeline, place: Point2) -> Option<usize> {
    let near = people.detections().iter().enumerate();
    let (index, distance_m) = near
        .map(|(index, detection)| (index, detection.position.distance(place)))
        .min_by(|a, b| a.1.total_cmp(&b.1))?;
    (distance_m < OWN_M).then_some(index)
}

/// Shares out the steps of a round over the time between two judgements.
struct Pace {
    update_us: u64,
    last: Option<Stamp>,
    /// Steps that are due, in parts of `update_us`.
    due: u64,
}

impl Pace {
    fn steps(&mut self, now: Stamp) -> u16 {
        let passed_us = match self.last.replace(now).map(|last| last.age(now)) {
            Some(Age::Past(passed_us)) => passed_us.min(PAUSE_US),
            _ => 0,
        };
        self.due += passed_us * u64::from(OnlineLearner::ROUND_STEPS);
        let steps = (self.due / self.update_us).min(STEPS_MAX);
        self.due = (self.due - steps * self.update_us).min(STEPS_MAX * self.update_us);
        steps as u16
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use floorguard_perception::people::shape::{SHAPE_FEATURES, ShapeVector};
    use floorguard_types::random::Pcg32;

    #[test]
    fn round_takes_one_update_period_after_pauses() {
        for (update_us, seconds) in [(30_000_000, 300), (5_000_000, 50), (3_600_000_000, 7_200)] {
            let mut pace = Pace { update_us, last: None, due: 0 };
            let mut sum = 0_u64;
            for sweep in 0..=seconds * 10 {
                sum += u64::from(pace.steps(Stamp::from_micros(sweep * 100_000)));
            }
            let rounds = seconds * 1_000_000 / update_us;
            assert_eq!(sum, rounds * u64::from(OnlineLearner::ROUND_STEPS), "{update_us}");
        }
        let mut pace = Pace { update_us: 5_000_000, last: None, due: 0 };
        assert_eq!(pace.steps(Stamp::from_micros(1)), 0);
        let after = [3_600_000_001, 3_600_000_002, 3_600_000_003, 3_600_000_004, 3_600_000_005];
        let steps: u64 = after.iter().map(|at| u64::from(pace.steps(Stamp::from_micros(*at)))).sum();
        assert!(steps <= 4 * STEPS_MAX, "{steps}");
        // A clock that runs backwards is no time to learn in.
        assert_eq!(pace.steps(Stamp::from_micros(5)), 0);
    }

    /// From the shipped classifier on: what the advice hears changes with the first update that is taken over, not before.
    #[test]
    fn first_accepted_update_is_used() {
        let mut random = Pcg32::new(7, 7);
        let mut drawn = |is_wanted: fn(f32) -> bool, span: f32, count: usize| -> Vec<ShapeVector> {
            let shapes =
                (0..400_000).map(|_| [(); SHAPE_FEATURES].map(|()| random.uniform_between(0.0, span)));
            shapes.filter(|shape| is_wanted(person_log_odds(shape))).take(count).collect()
        };
        let (people, others) = (drawn(|odds| odds > 0.5, 1.2, 500), drawn(|odds| odds < -0.5, 1.2, 200));
        // What the shipped classifier doubtfully takes for people stands about here.
        let doubtful_shape = drawn(|odds| (0.3..1.0).contains(&odds), 1.8, 1)[0];
        let label = |shapes: &[ShapeVector], is_person| {
            shapes.iter().map(|shape| LabelledShape { shape: *shape, is_person }).collect::<Vec<_>>()
        };
        let anchors = [label(&people[..200], true), label(&others, false)].concat();
        let slot = LearningSlot::default();
        let mut learner = PeopleLearner::new(&anchors, &Weights::ZERO, (5_000_000, slot));
        for step in 0..9_600_u32 {
            let (stamp, round) = (Stamp::from_micros(u64::from(step) * 100_000), step / 160);
            if step % 160 < 120 {
                let walker = people[random.below(people.len() as u32) as usize];
                let stander = doubtful_shape.map(|value| value + random.uniform_between(-0.01, 0.01));
                let walked = Point2::new(0.1 * (step % 160) as f32, 3.0);
                let sights = [
                    Sight { track: 2 * round, position: walked, shape: Some(&walker) },
                    Sight { track: 2 * round + 1, position: Point2::new(5.0, 0.0), shape: Some(&stander) },
                ];
                learner.learner.observe(stamp, sights.into_iter());
            }
            learner.learn(stamp);
            assert_eq!(learner.corrects, learner.learner.counters().accepted > 0);
            if learner.corrects {
                return;
            }
        }
        panic!("nothing was taken over: {:?}", learner.learner.counters());
    }
}
