//! Worlds that hurt: random scenes of everything that a robot's body can run into, one kind after the other.
//!
//! What is drawn is drawn from what real sites have, not from what the robot's sensors can see. Every world follows from a
//! seed and a number.

mod draft;
mod family;
mod motion;
mod people;
mod things;

pub use family::{Hazard, HazardFamily};
