//! Where dirt was seen: what most viewpoints agree on, as the floor was when it was first perceived and as it is now.

mod cell;
mod limit;
mod map;
mod rank;
mod spots;
mod tint;

pub use cell::SeenCell;
pub use limit::{CellState, DirtLimit, KeptScore, SeenLayer, Together};
pub use map::{Scores, SeenDirtMap, ViewOutcome};
pub use spots::{DirtSpot, DirtSpots, SPOTS_MAX};
