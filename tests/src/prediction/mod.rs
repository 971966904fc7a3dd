//! Predictions of recorded pedestrians (ETH and UCY): 8 steps of 0.4 s seen, 12 predicted, by the usual protocol: every window
//! of 20 consecutive steps of a person. Our predictor begins every set with nothing learnt and learns only from the past.

mod score;
mod tracks;

pub use score::{PredictionScore, Predictions, evaluate};
pub use tracks::{TrackRow, TrackSet, load, rows};
