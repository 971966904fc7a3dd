//! Following a path: lattice paths and cleaning tours by pure pursuit, single stretches by turning first.

mod follower;
mod foot;
mod stretch;

pub use follower::{Backing, FollowLimits, FollowState, PathFollower};
pub use foot::{Foot, aim, foot};
pub use stretch::{FollowConfig, Following, Stretch, follow};
