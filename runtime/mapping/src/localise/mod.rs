//! Where the robot is in a known map, without a hint: found, in doubt, or not known.
//!
//! Sources: Olson 2009 (coarse search whose blocks bound their poses); Lu and Milios 1997 for what follows. The best places of
//! the whole map are kept from search to search and judged by returns on walls and by beams through walls and furniture. A place counts
//! once its lead over every other one has come to enough over the path.

mod certainty;
mod choice;
mod config;
mod evidence;
mod freshness;
mod known_map;
mod localiser;
mod permanence;
mod places;
mod query;
mod searching;
mod support;
mod updates;

pub use choice::{Chosen, MapChoice};
pub use config::LocaliseConfig;
pub use known_map::KnownMap;
pub use localiser::{Belief, Localiser, LocaliserStatistics, Located};
pub use updates::{MapUpdater, UpdateConfig};

#[cfg(test)]
#[path = "campaign_tests.rs"]
pub(crate) mod campaign;
#[cfg(test)]
#[path = "failure_tests.rs"]
mod failures;
