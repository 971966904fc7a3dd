//! A list of people against a motion: distances, times to a collision, and when a stop for people may end.

mod meeting;
mod stop_triggers;

pub use meeting::Meeting;
pub use stop_triggers::StopTriggers;
