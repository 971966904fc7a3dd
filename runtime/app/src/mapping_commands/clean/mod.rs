//! `floorguard clean-map`: a lidar capture and its trajectory become a cloud without what moved.

mod arguments;
mod capture;
mod command;
mod people;
mod result;

pub use arguments::CleanArguments;
pub use command::run;
