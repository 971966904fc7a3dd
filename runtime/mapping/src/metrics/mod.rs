//! How good a trajectory is.

mod errors;
mod relations;
mod trajectory;

pub use errors::{
    ErrorStatistics, PosePair, RelativeErrors, StepLength, absolute_errors, associate, relative_errors,
};
pub use relations::{Relation, RelationError, RelationScore, read_relations, score_relations};
pub use trajectory::{TimedPose, TumError, pose_at, read_tum, write_tum, write_tum_in_space};
