//! Three-dimensional maps without people: two passes over a recording, the first for evidence, the second for the verdicts.

mod areas;
mod box_index;
mod cleaner;
mod images;
mod odometry;
mod person_boxes;
mod sweep;
mod thinned;
mod track;
mod voxels;

pub use areas::{AreaCount, RemovedAreas};
pub use box_index::BoxIndex;
pub use cleaner::{CleanConfig, CleanCounts, Cleaner};
pub use images::{BOXES_MAX, ImageBoxes, ImageCounts, ImageError, PeopleInImages, SizedCamera};
pub use odometry::SweepTracker;
pub use person_boxes::{PersonBoxes, SweepBoxes};
pub use sweep::{FAN_RINGS, RawReturn, RawSweep};
pub use thinned::Thinned;
pub use track::{Track, TrackError};
pub use voxels::GrowingVoxels;

#[cfg(test)]
mod images_tests;
