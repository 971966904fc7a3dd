//! Judges a simulated run by ground truth, independently of what the robot believes.
//!
//! The judge sees the true poses of robot, people and walls, and the commands that went to the drive. It never sees a
//! scan, a track or a decision's reason, so that a blind robot cannot talk itself into a good verdict.

#[cfg(test)]
mod coverage_tests;
mod digest;
#[cfg(test)]
mod excuse_tests;
mod exploration_outcome;
mod latency;
mod mission_outcome;
mod navigation_outcome;
mod orders;
mod outcome;
mod scanner_view;
mod shape;
mod standing_cause;
mod stops;
mod tour_outcome;
mod true_world;
mod truth;
mod verdict;
mod zone;

pub use digest::Digest;
pub use exploration_outcome::ExplorationReport;
pub use latency::Quantiles;
pub use mission_outcome::{MissionJudge, MissionOutcome, MissionReport};
pub use navigation_outcome::{NavigationJudge, NavigationReport};
pub use orders::{StopOrders, known_us};
pub use outcome::{Asked, Outcome, Standing};
#[cfg(test)]
pub use shape::distance_to_edge_m;
pub use stops::{StopJudge, StopReason};
pub use tour_outcome::TourReport;
pub use true_world::{TrueContacts, person, setup, thing};
pub use truth::{Truth, TruthPerson};
pub use verdict::{HeardOf, Judge, Verdict};
pub use zone::TrueZones;
