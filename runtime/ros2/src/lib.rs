//! A robot live in ROS 2 without a ROS installation: over DDS goes what a recording holds, under the names, types and stamps that
//! ROS 2 gives them; velocities, goals and orders come back.
//!
//! Nothing of it is needed by the guard and nothing waits for it: messages go through a bounded queue, and what does not fit is
//! dropped and counted. DDS as it is spoken here has no security at all; without a configured address it stays on this computer.

mod bridge;
mod costmap;
mod counters;
mod dds;
mod incoming;
mod loopback;
mod moment;
mod names;
mod nav2;
mod outgoing;
mod published;
mod requests;
mod restamp;
mod services;
mod velocities;

pub use bridge::{BridgeOptions, OpenError, RosBridge};
pub use counters::BridgeFigures;
pub use moment::{Restraint, RobotMoment};
pub use requests::RosRequest;
pub use velocities::{VelocityFeed, VelocityRoute};

#[cfg(test)]
mod tests;
