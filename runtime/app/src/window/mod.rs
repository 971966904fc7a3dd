//! `floorguard window`: a lidar that a motor turns becomes a window of surfaces, a plan of floor and ceiling, and pictures.

mod arguments;
mod at_end;
mod command;
mod output;
mod recording;
#[cfg(feature = "laboratory")]
mod simulated;

pub use arguments::WindowArguments;
pub use at_end::leave_window;
pub use command::run;

#[cfg(all(test, feature = "laboratory"))]
mod tests;
