//! The cleaning mission of the robot that drives: the same belief and navigator as in trials, with real bytes around.

mod progress;

pub use progress::{CellState, Doubt, MissionPhase, MissionProgress, MissionWatch, UncertainCell};
