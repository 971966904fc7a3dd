//! Following a path, for everybody: routes, cleaning tours and lattice paths.

mod follower;
mod foot;

pub use follower::{FollowLimits, FollowState, PathFollower};
pub use foot::{Foot, aim, foot};
