//! Maps without people: our remover beside a plain one of the literature, by labelled returns of simulated drives.

mod building;
mod camera;
mod chance;
mod driven;
mod erasor;
mod experiment;
mod octomap;
mod remove;
mod render;
mod revisit;
mod revisit_table;
mod score;
mod sim3d;
mod twice;
mod walkers;

pub use driven::{Driven, driven_revisit};
pub use experiment::people_removal;
pub use remove::{Outcome, Surveys, erasor, octomap, ours};
pub use revisit::{RevisitClouds, Revisited, Round};
pub use revisit_table::people_revisits;
pub use score::Score;
pub use twice::Twice;
