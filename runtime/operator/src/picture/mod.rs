//! Pictures of a run for people: what the robot drove, who was there, where it stopped and why.

mod canvas;
mod content;
mod palette;
mod panel;
mod spread;
mod top_view;

pub use content::{PersonPath, StopMark, TopView};
pub use panel::cause_colours;
pub use spread::spread;
