//! What a robot has learned, for the console, the verdict and the reports.

use floorguard_perception::online_learning::{LearnerCounters, OnlineLearner, Standing};
use serde::Serialize;

use floorguard_host::words::counted;

/// What was learned since the start.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct LearningReport {
    /// It began with what a file had kept, and not with the shipped classifier alone.
    pub resumed: bool,
    /// Tracks that were labelled people, labelled nobody, and left alone.
    pub tracks: [u32; 3],
    /// Examples to learn from: of people, of others.
    pub examples: [usize; 2],
    /// Examples held out to judge by: of people, of others.
    pub held_out: [usize; 2],
    /// Corrections taken over.
    pub accepted: u32,
    /// Corrections refused.
    pub refused: u32,
    /// Agreement with the labels of the examples held out, at the newest judgement: the mean of the shares of people and of others
    /// decided as labelled, by the shipped classifier and by what is in use. None before the first judgement.
    pub agreement: Option<[f32; 2]>,
    /// Shapes scored, and those that the learned model decided otherwise than the shipped classifier.
    pub shapes_scored: u64,
    /// See `shapes_scored`.
    pub decided_otherwise: u64,
}

impl LearningReport {
    pub(super) fn of(
        learner: &OnlineLearner,
        resumed: bool,
        [shapes_scored, decided_otherwise]: [u64; 2],
    ) -> Self {
        let LearnerCounters { people, non_people, silent, accepted, rejected, .. } = learner.counters();
        let [others, persons] = learner.store().counts();
        let [others_held, persons_held] = learner.store().held_out_counts();
        let mean = |standing: Standing| 0.5 * (standing.recall + standing.rejected);
        Self {
            resumed,
            tracks: [people, non_people, silent],
            examples: [persons, others],
            held_out: [persons_held, others_held],
            accepted,
            refused: rejected,
            agreement: learner.agreement().map(|both| both.map(mean)),
            shapes_scored,
            decided_otherwise,
        }
    }

    /// In a sentence.
    #[must_use]
    pub fn words(&self) -> String {
        let Self { tracks: [people, others, _], examples: [of_people, of_others], accepted, refused, .. } =
            self;
        let agreement = match self.agreement {
            Some([shipped, used]) => format!(
                "agreement with the tracks {:.1} % (shipped classifier {:.1} %)",
                100.0 * used,
                100.0 * shipped
            ),
            None => "too few examples for a judgement yet".to_owned(),
        };
        let (people, others) = (counted(*people, "person"), counted(*others, "other track"));
        let (updates, shapes_scored) = (counted(*accepted, "update"), counted(self.shapes_scored, "look"));
        format!(
            "{of_people} + {of_others} examples from {people} and {others}; {updates} taken over, {refused} refused; {agreement}; {} of {shapes_scored} decided otherwise",
            self.decided_otherwise
        )
    }
}
