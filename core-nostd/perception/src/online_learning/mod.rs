//! Learning on the robot: tracks label what was seen, a bounded model corrects the classifier that was shipped.
//!
//! What has walked like a person was one (P-expert); what has stood still for long and does not surely look like a person was
//! none (N-expert). A correction that is no better on what was held out is thrown away. All memory is fixed,
//! every call is bounded. Source: book, Online learning.

mod basis;
mod belief;
mod experts;
mod judge;
mod learner;
#[cfg(test)]
mod learner_tests;
mod samples;
mod track_history;
mod weights;

pub use basis::{BASIS, Basis};
pub use belief::{LearnedBeliefs, ShapeScores};
pub use experts::{ExpertRules, Verdict};
pub use judge::Standing;
pub use learner::{LearnerCounters, OnlineLearner, Sight};
pub use samples::{LabelledShape, SampleStore};
pub use weights::Weights;
