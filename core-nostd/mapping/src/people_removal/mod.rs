//! People out of maps: where camera boxes show them, and where later or earlier rays passed through them.
//!
//! The published way ([`LensCamera`] to [`revisits`]) knows people by boxes in pictures; free-space evidence ([`FreeSpace`],
//! [`SweepFan`], [`SweepJudge`]) needs no camera and also knows what moved without being recognised (book, Maps without people).

mod calibration;
mod camera;
mod columns;
mod evidence;
mod fan;
mod fan_clear;
mod floor_height;
mod free_space;
mod judge;
mod person_position;
mod pose_between;
mod removal_box;
mod revisits;
mod sightings;
mod voxels;

pub use calibration::{CalibrationError, checked_mounting};
pub use camera::{BrownLens, LensCamera};
pub use columns::{Column, ColumnGrid, ColumnGridTooSmall};
pub use evidence::{Evidence, EvidenceRule};
pub use fan::{FanReturn, SweepFan};
pub use fan_clear::{ClearRay, FanRule};
pub use floor_height::FloorHeight;
pub use free_space::{FreeSpace, SpaceReader, SweepCount};
pub use judge::{JudgeRule, JudgedSweep, PointVerdict, SweepJudge, SweepOutcome};
pub use person_position::{
    NoPosition, PersonBox, PositionMethod, SWEEP_AGE_MAX_US, is_of_image, person_position,
};
pub use pose_between::{StampedPose, pose_at};
pub use removal_box::{RemovalBox, RemovalSize};
pub use revisits::{RevisitRule, revisits};
pub use sightings::{Entered, SIGHTINGS, Sighting, Sightings};
pub use voxels::{Block, BlockKey, FixedVoxels, Voxel, VoxelStore};

#[cfg(test)]
mod camera_tests;
#[cfg(test)]
mod free_space_tests;
#[cfg(test)]
mod judge_tests;
