//! Drives to a goal on a known map: costmaps, a global plan, a local planner, and what to do when the robot does not come
//! forward. What comes out is a request; the guard decides.

mod course;
mod drive;
mod goal_search;
mod guard_model;
mod maps;
mod model;
mod plan;
mod progress;
mod reasons;
mod report;
mod senses;
mod setup;
mod steering;

pub use drive::Navigator;
pub use plan::{Journey, NavigationPlan, NavigationSettings};
pub use progress::{
    CostmapImage, NavigationPhase, NavigationProgress, NavigationWatch, SharedNavigationWatch,
};
pub use reasons::StandingReason;
pub use setup::NavigationSetup;
