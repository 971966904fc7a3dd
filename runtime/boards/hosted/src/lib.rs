//! The hosted board: carriers of Linux, recordings, the simulator, and the commands of the program.

#[macro_use]
mod console;

pub mod camera;
pub mod campaign;
pub mod capture;
pub mod carmen;
pub mod carriers;
pub mod cleaner;
pub mod commands;
pub mod display;
pub mod environment;
pub mod evaluate;
pub mod executor;
pub mod judge;
pub mod learning;
pub mod metrics;
pub mod mission;
pub mod models;
pub(crate) mod packing;
pub mod panel;
pub mod picture;
pub mod recording;
pub mod report;
pub mod robot;
pub mod status;
pub mod train;
pub mod world;

pub use floorguard_configuration as configuration;
