//! Where dirt was seen: a median over viewpoints, as the floor was when it was first perceived and as it is now.

mod cell;
mod map;
mod spots;

pub use cell::{CellState, SeenCell};
pub use map::{Scores, SeenDirtMap, SeenLayer, ViewOutcome};
pub use spots::{DirtSpot, DirtSpots, SPOTS_MAX};
