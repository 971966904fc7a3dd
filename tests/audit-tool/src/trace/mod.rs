//! Requirements and hazards, their tests, and what these print of the states.

mod marks;
pub mod picture;
mod requirements;
pub mod results;

pub use marks::Place;
#[cfg(test)]
pub use requirements::Hazard;
pub use requirements::{Requirement, Sources, Trace};
