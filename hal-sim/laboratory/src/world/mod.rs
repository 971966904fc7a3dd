//! The robot's tasks in a world: simulated on a virtual clock, simulated over real carriers, or real devices.

mod actuated_end;
mod by_hand;
mod ends;
mod floor_camera;
mod lidar_playback;
mod lines;
mod observation;
mod observer;
mod operator;
mod outside;
mod planning;
mod real_world;
mod recorded_plan;
mod scenario_file;
mod surveying;
mod swept_area;
mod true_state;
mod truth;
mod velocity_base;
mod virtual_world;
mod wheel_targets;

pub use crate::plan::{Plan, PlanError, plan_of_scenario};
pub use floor_camera::SimulatedCamera;
pub use observation::{AdvisedPeople, Observation, PATH_US, SeenStop};
pub use observer::{Observer, TRACKED_RANGE_M};
pub use real_world::{CarrierFigures, run_real, run_real_recorded};
pub use recorded_plan::{record_plan, record_plan_in_real_time, watch_plan};
pub use scenario_file::load_scenario;
pub use virtual_world::{run_recorded, run_virtual};
