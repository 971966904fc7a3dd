//! Exploration: where known floor borders on what nobody has seen (Yamauchi 1997).

mod explorer;
mod frontier;

pub use explorer::{Exploration, ExploreConfig, Explorer, FrontierCost};
pub use frontier::{FRONTIERS_MAX, Frontier, FrontierScratch, FrontierSearch, find_frontiers};
