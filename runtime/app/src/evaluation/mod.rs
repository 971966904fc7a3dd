//! `floorguard eval`: stages of the robot against keys.

mod command;
#[cfg(feature = "laboratory")]
mod stages;

pub use command::{EvalArguments, EvalStage, run};
#[cfg(feature = "laboratory")]
pub use stages::RecordedStage;
