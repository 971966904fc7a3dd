//! Where the robot is in a known map, without a hint: found, in doubt, or not known.
//!
//! Source: Hess et al. 2016, section V.B (branch and bound over the whole map); Lu and Milios 1997 for what follows. A place
//! counts once it stands alone, is not contradicted by what the scans saw through, and the searches of two metres agree.

mod config;
mod freshness;
mod known_map;
mod localiser;
mod places;
mod query;
mod searching;
mod support;

pub use config::LocaliseConfig;
pub use known_map::KnownMap;
pub use localiser::{Belief, Localiser, LocaliserStatistics, Located};

#[cfg(test)]
#[path = "campaign_tests.rs"]
mod campaign;
#[cfg(test)]
#[path = "failure_tests.rs"]
mod failures;
