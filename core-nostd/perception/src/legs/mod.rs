//! Legs in the scans of a two-dimensional scanner: segments, what each looks like, which are legs, and whose.
//!
//! Source: book, Legs (Arras et al. 2007 as coded in the people package). The classifier is ours, trained by
//! `floorguard train legs`.

mod cues;
mod detector;
mod features;
mod leg_table;
mod segments;
mod stumps;
mod tracks;
mod view;

pub use cues::{LEG_CUES, LegCues, PlaceEvidence, leg_cues};
pub use detector::{Leg, LegDetector, LegDetectorOf, LegLimits, LegOutput};
pub use features::{LEG_FEATURE_NAMES, LEG_FEATURES, LegFeatures, leg_features};
pub use segments::{Segment, Segments, SegmentsOf};
pub use stumps::{KnownPlaces, Stump, leg_score, leg_score_near_floor, near_floor_committee, score};
pub use tracks::{LEG_TRACKS_MAX, LegTrack, LegTracker, PersonByLegs, SeenPair};
pub use view::{LEGS_RECOGNISED_M, PeopleByLegs, PeopleByLegsOf};
