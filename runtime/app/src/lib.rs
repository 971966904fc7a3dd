//! The program `floorguard`: its commands.

#[macro_use]
extern crate floorguard_host;

pub mod cameras;
pub mod commands;
pub mod doctor;
pub mod evaluation;
pub(crate) mod files;
pub mod fleets;
pub mod learning;
pub mod mapping_commands;
pub mod recordings;
pub mod reports;
pub mod robot_file;
pub mod window;
