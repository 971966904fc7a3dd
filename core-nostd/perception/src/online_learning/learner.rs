//! The learner: track histories in, corrected log-odds out, and never worse than what was shipped.

use heapless::Vec;

use super::basis::Basis;
use super::experts::{ExpertRules, Verdict};
use super::judge::{Baselines, Standing, in_place, is_better, is_harmless, on_anchors};
use super::samples::{LabelledShape, SampleStore};
use super::track_history::TrackHistory;
use super::weights::Weights;
use crate::shapes::shape::ShapeVector;
use floorguard_types::capacities::{LEARNING_ANCHORS, LEARNING_TRACKS};
use floorguard_types::geometry::Point2;
use floorguard_types::number::exact_usize;
use floorguard_types::random::Pcg32;
use floorguard_types::time::{Age, Stamp};

/// A track that was not seen for this long has ended, µs.
const ENDED_US: u64 = 2_000_000;
/// Steps from one judgement to the next: each sample of a full store about twice.
const ROUND_STEPS: u32 = 2_000;
/// Share of the steps that go to anchors, one in so many: elsewhere everything is to stay as it was.
const ANCHOR_EVERY: u32 = 2;
/// Samples of each class before anything is learnt.
const SAMPLES_MIN: usize = 16;

/// Where a track is in this sweep, and its shape if it was seen.
#[derive(Clone, Copy, Debug)]
pub struct Sight<'a> {
    /// Number of the track.
    pub track: u32,
    /// Fixed frame.
    pub position: Point2,
    /// The detection that was given to it.
    pub shape: Option<&'a ShapeVector>,
}

/// What happened so far.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct LearnerCounters {
    /// Tracks that the P-expert called people.
    pub people: u32,
    /// Tracks that the N-expert called nobody.
    pub non_people: u32,
    /// Tracks of which neither could tell.
    pub silent: u32,
    /// Corrections taken over.
    pub accepted: u32,
    /// Corrections thrown away.
    pub rejected: u32,
    /// Tracks beyond the capacity.
    pub dropped: u32,
}

/// All memory of the learning. Invariant: the weights in use have passed the judgement, or are zero.
#[derive(Clone, Debug)]
pub struct OnlineLearner {
    rules: ExpertRules,
    basis: Basis,
    anchors: Vec<LabelledShape, LEARNING_ANCHORS>,
    shipped: Standing,
    used: Weights,
    tried: Weights,
    round: u32,
    histories: Vec<TrackHistory, LEARNING_TRACKS>,
    store: SampleStore,
    random: Pcg32,
    counters: LearnerCounters,
    agreement: Option<[Standing; 2]>,
}

impl OnlineLearner {
    /// A learner that has seen nothing. The anchors are samples with a known truth, of both classes, that did not make
    /// the shipped classifier; as many are kept as fit.
    #[must_use]
    pub fn new(anchors: &[LabelledShape], rules: ExpertRules) -> Self {
        let basis = Basis::new(anchors.iter().map(|anchor| &anchor.shape));
        let mut kept = Vec::new();
        for anchor in anchors.iter().take(LEARNING_ANCHORS) {
            // Within the capacity: a push cannot fail.
            let _ = kept.push(*anchor);
        }
        let shipped = on_anchors(&Weights::ZERO, &basis, &kept);
        Self {
            rules,
            basis,
            anchors: kept,
            shipped,
            used: Weights::ZERO,
            tried: Weights::ZERO,
            round: 0,
            histories: Vec::new(),
            store: SampleStore::new(),
            random: Pcg32::new(0x1EA2, 1),
            counters: LearnerCounters::default(),
            agreement: None,
        }
    }

    /// Goes on with weights that were learnt before. True if they were taken: unsound ones, and ones that do worse on the
    /// anchors than the shipped classifier, are not.
    pub fn resume(&mut self, weights: &Weights) -> bool {
        let standing = on_anchors(weights, &self.basis, &self.anchors);
        let taken = weights.is_sound() && is_harmless(standing, self.shipped);
        if taken {
            self.used = *weights;
            self.tried = *weights;
        }
        taken
    }

    /// Log-odds that a shape is a person, by what is in use.
    #[must_use]
    pub fn log_odds(&self, shape: &ShapeVector) -> f32 {
        self.used.log_odds(&self.basis, shape)
    }

    /// Takes in one sweep: all tracks, each once.
    pub fn observe<'a>(&mut self, stamp: Stamp, sights: impl Iterator<Item = Sight<'a>>) {
        for sight in sights.take(LEARNING_TRACKS) {
            let known = self.histories.iter().position(|history| history.track == sight.track);
            let index = known.unwrap_or(self.histories.len());
            if known.is_none()
                && self.histories.push(TrackHistory::new(sight.track, stamp, sight.position)).is_err()
            {
                self.counters.dropped = self.counters.dropped.saturating_add(1);
                continue;
            }
            let Some(history) = self.histories.get_mut(index) else { continue };
            history.enter(stamp, sight.position);
            if let Some(shape) = sight.shape {
                let log_odds = self.used.log_odds(&self.basis, shape);
                history.add_shape(shape, log_odds, &mut self.random);
            }
        }
        self.close(stamp);
    }

    /// Judges tracks that have ended or have stood for long enough.
    fn close(&mut self, now: Stamp) {
        for index in (0..LEARNING_TRACKS).rev() {
            let Some(history) = self.histories.get(index) else { continue };
            let gone = !matches!(history.last.age(now), Age::Past(age) if age < ENDED_US);
            let summary = history.summary();
            if !(gone || self.rules.is_ripe(&summary)) {
                continue;
            }
            let history = self.histories.swap_remove(index);
            let shapes = history.shapes.iter();
            match self.rules.judge(&summary) {
                Verdict::Person => {
                    self.counters.people = self.counters.people.saturating_add(1);
                    self.store.add(true, shapes, &mut self.random);
                }
                Verdict::NotAPerson => {
                    self.counters.non_people = self.counters.non_people.saturating_add(1);
                    self.store.add(false, shapes, &mut self.random);
                }
                Verdict::Silent => self.counters.silent = self.counters.silent.saturating_add(1),
            }
        }
    }

    /// Steps from one judgement to the next, for the scheduler.
    pub const ROUND_STEPS: u32 = ROUND_STEPS;

    /// Learns for at most `steps` steps; at the end of a round what was learnt is judged. Call it when there is time.
    pub fn learn(&mut self, steps: u16) {
        if self.store.counts().iter().any(|count| *count < SAMPLES_MIN) {
            return;
        }
        for _ in 0..steps {
            self.round = self.round.saturating_add(1);
            let is_person = self.round.is_multiple_of(2);
            if (self.round / 2).is_multiple_of(ANCHOR_EVERY) {
                self.practise();
            } else if let Some(shape) = self.store.draw(is_person, &mut self.random) {
                self.tried.step(&self.basis, shape, Some(is_person));
            }
            if self.round >= ROUND_STEPS {
                self.judge();
            }
        }
    }

    /// One step back to the shipped answer at an anchor.
    fn practise(&mut self) {
        let count = u32::try_from(self.anchors.len()).unwrap_or(0).max(1);
        if let Some(anchor) = self.anchors.get(exact_usize(self.random.below(count))) {
            self.tried.step(&self.basis, &anchor.shape, None);
        }
    }

    /// Takes over what was learnt, or throws it away.
    fn judge(&mut self) {
        self.round = 0;
        let stands = |weights: &Weights| in_place(weights, &self.basis, &self.store);
        let standings = stands(&self.tried).zip(stands(&self.used)).zip(stands(&Weights::ZERO));
        let Some(((new, used), shipped)) = standings else { return };
        self.agreement = Some([shipped, used]);
        let anchors = on_anchors(&self.tried, &self.basis, &self.anchors);
        let rivals = Baselines { used, shipped, shipped_on_anchors: self.shipped };
        if self.tried.is_sound() && is_better(new, anchors, &rivals) {
            self.used = self.tried;
            self.agreement = Some([shipped, new]);
            self.counters.accepted = self.counters.accepted.saturating_add(1);
        } else {
            self.tried = self.used;
            self.counters.rejected = self.counters.rejected.saturating_add(1);
        }
    }

    /// The weights in use: what a file keeps.
    #[must_use]
    pub const fn weights(&self) -> &Weights {
        &self.used
    }

    /// What happened so far.
    #[must_use]
    pub const fn counters(&self) -> LearnerCounters {
        self.counters
    }

    /// The labelled samples.
    #[must_use]
    pub const fn store(&self) -> &SampleStore {
        &self.store
    }

    /// How the shipped classifier and what is in use agreed with the experts about the held-out shapes, at the newest
    /// judgement; `None` before the first one.
    #[must_use]
    pub const fn agreement(&self) -> Option<[Standing; 2]> {
        self.agreement
    }

    /// How the shipped classifier and what is in use stand on the anchors.
    #[must_use]
    pub fn on_anchors(&self) -> [Standing; 2] {
        [self.shipped, on_anchors(&self.used, &self.basis, &self.anchors)]
    }
}
