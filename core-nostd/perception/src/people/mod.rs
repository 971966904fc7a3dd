//! People: from a sweep to tracks with identity, velocity and doubt.
//!
//! [`clusters`](crate::clusters) → candidates → [`shapes`](crate::shapes) → [`tracking`](crate::tracking). What a caller
//! of the pipeline needs of these stands here, too. Source: book, People; book, Tracking.

mod candidate_shapes;
mod candidates;
mod pipeline;
mod splits;

pub use crate::clusters::{
    Cluster, ClusterLimits, FloorHeight, FloorMask, RingAngles, SeenReturn, hangs, returns_in_base,
    ring_clusters, turn_over, turned_over_mounting,
};
pub use crate::shapes::{classify, person_model, shape};
pub use crate::tracking::{
    Appearance, AppearanceOf, Association, ConstantVelocity, Detection, DetectionOf, Explanation,
    GROUP_DETECTIONS, GROUP_TRACKS, JointGroup, Marginals, OpenSpace, PEOPLE_SENSORS, PeopleSensor,
    PeopleView, PeopleViewOf, SensorSet, Sightings, SightingsOf, Surroundings, Track, TrackOf, TrackStatus,
    Tracker, TrackerOf, TrackerParameters, VIEW_PEOPLE_MAX, VIEWS_WAITING, filters,
};
pub use candidates::CandidateLimits;
pub use pipeline::{
    PeopleCounters, PeopleOutput, PeopleOutputOf, PeoplePipeline, PeoplePipelineOf, SweepContext,
};
