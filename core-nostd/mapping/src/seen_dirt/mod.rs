//! Where dirt was seen: what most viewpoints agree on, as the floor was when it was first perceived and as it is now.

mod cell;
mod map;
mod rank;
mod spots;
mod tint;

pub use cell::{CellState, DirtLimit, KeptScore, SeenCell, SeenLayer, Together};
pub use map::{Scores, SeenDirtMap, ViewOutcome};
pub use spots::{DirtSpot, DirtSpots, SPOTS_MAX};
