//! Legs in the scans of a two-dimensional scanner: segments, what each looks like, which are legs, and whose.
//!
//! Source: book, Legs (Arras et al. 2007 as coded in the people package). The classifier is ours, trained by
//! `floorguard train legs`.

mod detector;
mod features;
mod leg_table;
mod segments;
mod stumps;
mod tracks;
mod view;

pub use detector::{Leg, LegDetector, LegDetectorOf, LegLimits, LegOutput};
pub use features::{LEG_FEATURE_NAMES, LEG_FEATURES, LegFeatures, leg_features};
pub use segments::{Segment, Segments, SegmentsOf};
pub use stumps::{Stump, leg_score, leg_score_near_floor, score};
pub use tracks::{LEG_TRACKS_MAX, LegTrack, LegTracker, PersonByLegs};
pub use view::{PeopleByLegs, PeopleByLegsOf};
