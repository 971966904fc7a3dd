//! Plays a scenario on virtual time: physics, people, sensors and buses in one sequence of events.

mod bus;
mod dirt;
mod engine;
mod event;
mod look;
mod misplaced;
mod touch;
mod truth;

pub use engine::Simulation;
pub use event::{Payload, Stream, WireEvent};
pub use truth::{PersonTruth, Truth, distance_to_area};
