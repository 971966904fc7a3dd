//! A lidar on its side that a motor turns: both wires, the window of surfaces around the robot, and the people who walk through it
//! (book, Sliding window). The guard does not hear of it; what it sees of people goes into the one list of them.

mod boxes;
mod live;
mod session;
mod watch;
mod window_map;

pub use boxes::{ReceivedBoxes, read_boxes};
pub use live::{WindowLinks, watch_window};
pub use session::Session;
pub use watch::{WindowReport, WindowWatch};
pub use window_map::{Refusals, Taken, WindowMap, WindowSetup};

#[cfg(test)]
mod live_tests;
