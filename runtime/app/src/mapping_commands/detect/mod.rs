//! `floorguard detect-people`: boxes of people in pictures, by a detector that the user brings.

mod command;
mod pictures;

pub use command::{DetectArguments, run};
