//! Where people will be: constant velocity, corrected by what was learnt of this place.
//!
//! Measured on recorded pedestrians (8 steps of 0.4 s seen, 12 predicted) two objects help: how much people here keep
//! their speed and their turns, and where others went on from the same spot. Repulsion between people (social forces)
//! was tried as features of the same model and did not help on any of the sets; it is not here.

mod doubt;
mod motion_model;
mod place_flow;
mod predictor;
mod trail;

pub use doubt::Doubt;
pub use motion_model::{FEATURES, MotionModel};
pub use place_flow::{FLOW_HEADINGS, FlowCell, PlaceFlow};
pub use predictor::{PeoplePredictor, PredictedPath, PredictedPlace};
pub use trail::{PersonTrail, SEEN_STEPS};

/// Time from step to step, seconds.
pub const STEP_S: f32 = 0.4;
/// Steps predicted.
pub const STEPS: usize = 12;
