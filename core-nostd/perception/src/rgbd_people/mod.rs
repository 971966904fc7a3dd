//! People in the pictures of a forward depth camera: upper bodies by their silhouette, legs near the robot.
//!
//! Depth image → floor grid → regions → crops → silhouette → people; the band above the floor → legs → pairs. What has
//! no depth is unknown: it neither makes a person nor speaks against one. Source: book, Depth people.

mod band;
mod contour;
mod crop;
mod detection;
mod finder;
mod floor_frame;
mod floor_grid;
mod leg_pairs;
mod leg_parts;
mod matching;
mod parameters;
mod regions;
mod silhouette;
mod suppression;
mod upper_bodies;

pub use detection::{RgbdCounters, RgbdDetection, RgbdKind, RgbdPeople};
pub use finder::RgbdPeopleFinder;
pub use floor_frame::CameraMount;
pub use leg_parts::LegCandidate;
pub use parameters::{LegRules, RgbdParameters, UpperBodyRules};
pub use silhouette::{AREAS, Area, SILHOUETTE_SIDE, Silhouette, SilhouettePixel, SilhouetteShape};
