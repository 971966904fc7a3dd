//! `floorguard clean-map`: a lidar's recording and its trajectory become a cloud without people and what else moved.

mod arguments;
mod boxes_file;
mod capture;
mod clouds;
mod command;
mod input;
mod people;
mod report;
mod result;
mod surveys;

pub use arguments::{BoxMethod, CleanArguments};
pub use command::run;
