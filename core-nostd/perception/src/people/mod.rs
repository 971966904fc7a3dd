//! People: from a sweep to tracks with identity, velocity and doubt.
//!
//! Ground → clusters → candidates → tracker, on the range image: neighbourhood is index arithmetic, no tree is built.
//! Source: book, People; book, Tracking.

mod appearance;
mod association;
mod candidate_shapes;
mod candidates;
pub mod classify;
mod cluster;
mod clusters;
mod filter;
pub mod filters;
mod floor_height;
mod ground;
mod joint;
mod labels;
mod memory;
pub mod person_model;
mod person_table;
mod pipeline;
mod projection;
pub mod ring_clusters;
mod sensors;
pub mod shape;
mod splits;
mod track;
mod tracker;
mod views;
mod visibility;

pub use appearance::{Appearance, AppearanceOf};
pub use association::Association;
pub use candidates::{CandidateLimits, Detection, DetectionOf};
pub use cluster::{Cluster, ClusterLimits};
pub use filter::ConstantVelocity;
pub use floor_height::FloorHeight;
pub use ground::FloorMask;
pub use joint::{GROUP_DETECTIONS, GROUP_TRACKS, JointGroup, Marginals};
pub use pipeline::{
    PeopleCounters, PeopleOutput, PeopleOutputOf, PeoplePipeline, PeoplePipelineOf, SweepContext,
};
pub use projection::RingAngles;
pub(crate) use projection::SweepFrame;
pub use sensors::{PEOPLE_SENSORS, PeopleSensor, SensorSet};
pub(crate) use track::{BELIEF_MAX, SHAPE_EVIDENCE_MAX};
pub use track::{Track, TrackOf, TrackStatus};
pub use tracker::{Sightings, SightingsOf, Tracker, TrackerOf, TrackerParameters};
pub use views::{PeopleView, PeopleViewOf, VIEW_PEOPLE_MAX, VIEWS_WAITING};
pub use visibility::OpenSpace;
