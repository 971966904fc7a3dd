//! The hosted board: carriers of Linux, recordings, the simulator, and the commands of the program.

pub mod carriers;
pub mod commands;
pub mod configuration;
pub mod executor;
pub mod judge;
