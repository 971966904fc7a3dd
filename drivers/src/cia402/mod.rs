//! Drives of the CiA 402 profile: state machine and controlwords (book, CANopen: CiA 402 drives).

mod state;

pub use state::{DriveGoal, PowerState, controlword, profile_error};
