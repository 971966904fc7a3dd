//! Plays a scenario on virtual time: physics, people, sensors and buses in one sequence of events.

mod arrivals;
mod broken;
mod bus;
mod dirt;
mod engine;
mod look;
mod misplaced;
mod touch;
mod truth;

pub use engine::Simulation;
pub use truth::{PersonTruth, Truth};
