//! `floorguard window`: a lidar that a motor turns becomes a window of surfaces, a plan of floor and ceiling, and pictures.

mod arguments;
mod command;
// Recordings need a part of it, the simulated rig all.
#[cfg_attr(not(feature = "laboratory"), allow(dead_code))]
mod map;
mod output;
mod recording;
#[cfg(feature = "laboratory")]
mod session;
#[cfg(feature = "laboratory")]
mod simulated;

pub use arguments::WindowArguments;
pub use command::run;

#[cfg(all(test, feature = "laboratory"))]
mod tests;
