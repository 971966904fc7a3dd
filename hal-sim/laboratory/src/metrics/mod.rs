//! How well tracks agree with the truth: CLEAR-MOT and IDF1.

mod accumulator;
mod assignment;
mod identity;
mod summary;

pub use accumulator::{MotAccumulator, POINT_GATE_M};
pub use summary::MotSummary;
