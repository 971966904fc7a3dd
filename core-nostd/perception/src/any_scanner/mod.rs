//! People by the legs that any two-dimensional scanner sees, at whatever height it is and whether or not its motion is
//! known: what has stood around it, and who walks. In the memory of a computer.
//!
//! Source: book, Legs: Any scanner.

mod gait;
mod people;
mod places;

pub use people::{PeopleByAnyScanner, PeopleByAnyScannerOf, ScannerPose};
pub use places::{Places, PlacesOf};
