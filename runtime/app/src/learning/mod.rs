//! What the robot learns and what it answers: `learn`, `ask`, `train`.

mod ask;
mod learn;
#[cfg(feature = "laboratory")]
mod train;
#[cfg(all(feature = "laboratory", feature = "detector"))]
mod train_detector;

pub use ask::{AskArguments, AskQuestion, run as ask};
pub use learn::{LearnArguments, PlaceArguments, run as learn};
pub(crate) use learn::{bad, bounds, open};
#[cfg(feature = "laboratory")]
pub use train::{TrainArguments, TrainPeopleArguments, TrainWhat, run as train};
