//! Drives to a goal on a known map, or makes one: costmaps, a global plan, a local planner, and what to do when the robot does not come
//! forward. What comes out is a request; the guard decides.

mod backing;
mod course;
mod dock_sight;
mod docking;
mod drive;
mod exploring;
mod goal_search;
mod goals;
mod guard_model;
mod local_planning;
mod maps;
mod model;
#[cfg(test)]
mod parked_tests;
mod place;
mod plan;
mod progress;
mod reasons;
mod report;
mod senses;
mod setup;
mod space_inbox;
mod steering;
mod survey;
mod touring;

pub use drive::Navigator;
pub use goals::{DriveOrder, DriveOrders, OrderedGoal, WayLimits};
pub use guard_model::GuardModel;
pub use local_planning::LocalPlanning;
pub use plan::{Journey, NavigationPlan, NavigationSettings};
pub use progress::{
    CostmapImage, ExplorationProgress, NavigationPhase, NavigationProgress, NavigationWatch,
    SharedNavigationWatch, TourProgress,
};
pub use reasons::StandingReason;
pub use setup::NavigationSetup;
pub use space_inbox::{BodyExtent, SpaceInbox, SpaceSight, sight_of};
pub use survey::{SharedSurvey, Survey, SurveyedMap, locked};
