//! Where dirt was seen: a median over viewpoints, as the floor was when it was first perceived and as it is now.

mod cell;
mod map;
mod spots;

pub use cell::{CellState, KeptScore, SeenCell, SeenLayer};
pub use map::{Scores, SeenDirtMap, ViewOutcome};
pub use spots::{DirtSpot, DirtSpots, SPOTS_MAX};
