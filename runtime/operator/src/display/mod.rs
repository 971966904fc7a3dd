//! What the user sees while the robot runs. Everything here goes to standard error.

mod held_history;
mod live;
mod status;

pub use held_history::{HeldEvent, HeldHistory, HeldKind};
pub use live::LiveDisplay;
pub use status::{SourceStatus, Status};
