//! Following a path: poses that are to be met exactly, with their gears (`follower`); single stretches by turning first
//! (`stretch`); routes of points whose corners may be cut, for laps and test drives (`route`).

mod follower;
mod foot;
mod stretch;

pub use follower::{Backing, FollowLimits, FollowState, PathFollower};
pub use foot::{Foot, aim, foot};
pub use stretch::{FollowConfig, Following, Stretch, follow};
