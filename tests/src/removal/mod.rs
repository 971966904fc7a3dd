//! Maps without people: our remover beside a plain one of the literature, by labelled returns of simulated drives.

pub mod building;
mod chance;
mod experiment;
mod octomap;
mod remove;
pub mod render;
mod score;
mod sim3d;
mod walkers;

pub use experiment::people_removal;
pub use octomap::OctoMap;
pub use score::Score;
