//! The robot on this computer: both rings on threads of their own, on the carriers that `robot.toml` names.

mod commanded;
mod guard_task;
mod inbox;
mod latch_file;
mod legs;
mod links;
mod rings;
mod second_look;
mod spawn;
mod stop_files;
mod tap;

pub use commanded::{spawn_commanded, spawn_velocity_base, velocity_rules};
pub use guard_task::GuardTask;
pub use inbox::PeopleInbox;
pub use latch_file::{LatchFile, latched_words};
pub use legs::HostedLegs;
pub use links::{ImuLink, Links, Missing, ScannerLink};
pub use rings::{HostedShared, StopsAtEnd, run_rings};
pub use second_look::SecondLook;
pub use spawn::{
    GuardCarriers, HostedMotion, HostedPerception, ScannerCarrier, Stages, guard_for, new_perception,
    new_shared, new_shared_for, spawn_guard_ring, spawn_mission_ring, spawn_perception_ring,
};
pub use stop_files::{black_box_log, write_stop_file};
pub use tap::{Direction, Poll, Tap, TapRow, TapRows, Tapped, tap};
