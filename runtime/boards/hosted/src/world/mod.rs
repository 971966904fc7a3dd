//! The robot's tasks in a world: simulated on a virtual clock, simulated over real carriers, or real devices.

mod ends;
mod floor_camera;
mod inbox;
mod observer;
mod onlooker;
mod operator;
mod plan;
mod real_world;
mod replayed_world;
mod scanner_pipe;
mod scenario_file;
mod spawn;
mod swath;
mod tape;
mod truth;
mod virtual_world;
mod witnesses;

pub use floor_camera::SimulatedCamera;
pub use inbox::PeopleInbox;
pub use observer::{Observation, Observer, PeopleSeen, SeenStop, TRACKED_RANGE_M};
pub use onlooker::{Notes, with_onlooker};
pub use plan::{Plan, PlanError};
pub use real_world::{CarrierFigures, run_real, run_real_recorded};
pub use replayed_world::{ReplayAudience, ReplayError, ReplayOutcome, is_replayable, replay_recording};
pub use scenario_file::load_scenario;
pub use spawn::{
    GuardCarriers, HostedMotion, HostedPerception, ScannerCarrier, Stages, new_perception, new_shared,
    spawn_cleaning_ring, spawn_guard_ring, spawn_perception_ring,
};
pub use swath::BRUSH_M;
pub use tape::Tape;
pub use virtual_world::{run_recorded, run_virtual};
pub use witnesses::{FileRecorder, Witnesses};
