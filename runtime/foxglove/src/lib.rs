//! A run live in Foxglove: what a recording holds goes over a WebSocket while it is made. The app shows it without a plugin.
//!
//! Nothing that a viewer sends reaches the robot, and a viewer that stalls loses messages, counted; nobody waits for it.

mod client;
mod protocol;
mod server;
mod viewers;

pub use server::{FoxgloveServer, OpenError};
pub use viewers::LiveFigures;

#[cfg(test)]
mod tests;
