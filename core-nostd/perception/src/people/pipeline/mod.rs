//! The whole way from a sweep to the list of people: things, candidates, looks at their shapes, tracks.

mod body_box;
mod candidates;
mod context;
mod looking;
mod sharing;
mod state;
mod things;
mod upper_bodies;

pub use context::{PeopleCounters, PeopleOutput, SweepContext};
pub use state::PeoplePipeline;
