//! The static worlds of the BARN navigation benchmark (Perille and others 2020): fields of cylinders that a small fast robot
//! crosses, driven by our two local planners.
//!
//! The judge knows the cylinders and the robot's rectangle; the planners know a simulated scanner. Rule of the benchmark:
//! success × optimal time / time, with the time clipped to 4 and 8 optimal times; the optimal time is that of the reference
//! path at 2 m/s.

mod archive;
mod drive;
mod recovery;
mod robot;
mod score;
mod stack;
mod world;

pub use drive::{Outcome, drive};
pub use robot::{Which, jackal};
pub use score::{Score, Summary, summarise};
pub use stack::mppi;
pub use world::{World, load};
