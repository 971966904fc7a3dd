//! Exploration of recorded buildings with an ideal scanner: our view points in the order of a short way, beside the published
//! rules, and how much longer the way was than the best tour of the same view points by one who knew the building.

mod building;
mod drive;
mod hindsight;
mod rules;
mod table;

pub use building::{BUILDINGS, Building};
pub use drive::{Explored, explore};
pub use hindsight::best_tour_m;
pub use rules::Rules;
pub use table::exploration;
