//! What is played: a scenario with its robot, seed, faults and mission, before anything runs.

mod mission_plan;
mod outside;
mod recorded_lidar;
mod run_plan;
mod true_robot;

pub(crate) use mission_plan::survey;
pub use mission_plan::{navigation_of_scenario, plan_of_scenario};
pub use outside::{HeardAt, OutsideProgram, SentFrame, Stretch};
pub use recorded_lidar::RecordedLidar;
pub use run_plan::{Plan, PlanError};
