//! Runs: async tasks generic over device traits, latest-value signals and bounded queues, the same on every board.
//!
//! A task is a plain `async fn` over the traits in [`io`]; a board supplies carriers, spawns the tasks on its two
//! executors (guard ring, perception ring) and shares one [`shared::Shared`] between them. Nothing here allocates,
//! blocks, or knows which board it runs on.
#![no_std]
#![forbid(unsafe_code)]

#[cfg(test)]
extern crate std;

pub mod black_box;
pub mod black_box_log;
pub mod channel;
pub mod clock;
pub mod configuration;
pub mod digest;
mod doubled;
pub mod io;
pub mod kept_latches;
pub mod mission;
pub mod shared;
pub mod tape;
pub mod tasks;
