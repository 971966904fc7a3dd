//! Maps without people: our remover beside a plain one of the literature, by labelled returns of simulated drives.

mod building;
mod chance;
mod experiment;
mod octomap;
mod remove;
mod render;
mod score;
mod sim3d;
mod twice;
mod walkers;

pub use experiment::people_removal;
pub use remove::{Outcome, Surveys, octomap, ours};
pub use score::Score;
pub use twice::Twice;
