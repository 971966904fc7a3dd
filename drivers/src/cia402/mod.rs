//! Drives of the CiA 402 profile: state machine and controlwords (wire-formats 6.3).

mod state;

pub use state::{DriveGoal, PowerState, controlword, profile_error};
