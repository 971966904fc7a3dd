//! What is played: a scenario with its robot, seed, faults and mission, before anything runs.

mod mission_plan;
mod run_plan;

pub use mission_plan::{navigation_of_scenario, plan_of_scenario};
pub use run_plan::{Plan, PlanError};
