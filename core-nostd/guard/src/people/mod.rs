//! What a list of people means for a motion: who is near, who is reached, and when a stop for them may end.

mod meeting;
mod stop_triggers;

pub use meeting::Meeting;
pub use stop_triggers::StopTriggers;
