//! Tracking: from detections of all sensors to tracks with identity, velocity and doubt.
//!
//! Source: book, Tracking.

mod appearance;
mod association;
mod detection;
mod explanation;
mod filter;
pub mod filters;
mod joint;
mod memory;
mod sensors;
mod track;
mod tracker;
mod views;
mod visibility;

pub(crate) use appearance::Shades;
pub use appearance::{Appearance, AppearanceOf};
pub use association::Association;
pub use detection::{Detection, DetectionOf};
pub use explanation::{Explanation, Surroundings};
pub use filter::ConstantVelocity;
pub use joint::{GROUP_DETECTIONS, GROUP_TRACKS, JointGroup, Marginals};
pub use sensors::{PEOPLE_SENSORS, PeopleSensor, SensorSet};
pub(crate) use track::{BELIEF_MAX, SHAPE_EVIDENCE_MAX};
pub use track::{Track, TrackOf, TrackStatus};
pub use tracker::{Sightings, SightingsOf, Tracker, TrackerOf, TrackerParameters};
pub(crate) use views::WaitingViews;
pub use views::{PeopleView, PeopleViewOf, VIEW_PEOPLE_MAX, VIEWS_WAITING};
pub use visibility::OpenSpace;
pub(crate) use visibility::Visibility;
