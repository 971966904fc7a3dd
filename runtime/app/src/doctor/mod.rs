//! `floorguard doctor`: is this computer ready to drive the robot, and what is missing?

mod command;
mod computer;
mod devices;
mod finding;
mod holders;
mod system;

pub use command::{DoctorArguments, run};

#[cfg(test)]
mod tests;
