//! What people see of the robot: panel, report, pictures, the display of the terminal, and who records and shows a run.

#[macro_use]
extern crate floorguard_host;

pub mod display;
pub mod incident;
pub mod panel;
pub mod picture;
pub mod report;
pub mod surroundings;
pub mod telemetry;
pub mod words;
