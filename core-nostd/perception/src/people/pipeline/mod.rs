//! The whole pipeline from a sweep to the list of people: clusters, candidates, candidate shapes, tracks.

mod body_box;
mod candidates;
mod context;
mod describe;
mod find_clusters;
mod second_look;
mod sharing;
mod state;
mod upper_bodies;

pub use context::{PeopleCounters, PeopleOutput, PeopleOutputOf, SweepContext};
pub use state::{PeoplePipeline, PeoplePipelineOf};

#[cfg(test)]
mod vlp16_tests;
