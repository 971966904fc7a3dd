//! What the user sees while the robot runs. Everything here goes to standard error.

mod live;
mod status;

pub use live::LiveDisplay;
pub use status::{SourceStatus, Status};
