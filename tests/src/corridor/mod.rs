//! A simulated office corridor with one walker and a driving lidar: the published protocol for moving objects.
//!
//! After the protocol of Rath et al. 2020: walls, clutter along them, a person who walks at 0.5 to 1.5 m/s, and poses
//! with the noise of an odometry (5 mm, 0.1°). One seed is one run.

mod published;
mod score;
mod trial;
mod world;

pub use published::Published;
pub use score::Score;
pub use trial::{Method, Run, judge, record};
pub use world::{Moment, World};
