//! The tasks, as plain `async fn`: a board wraps each in one line and spawns it on the ring that it belongs to.
//!
//! | ring | tasks |
//! |---|---|
//! | guard | [`lidar_input`], [`scanner_input`], [`rear_scanner_input`], [`imu_input`], [`can_bus`] or [`velocity_base`], [`supervise`], [`command_input`], [`advice_input`], [`operator_input`], [`velocity_input`] |
//! | perception | [`perceive`], and [`drive_route`] or [`drive_mission`] |

mod advise;
mod bus_base;
mod buttons;
mod can;
mod drive_order;
mod imu;
mod inputs;
mod lidar;
mod mission;
mod moved_along;
#[cfg(test)]
mod moved_along_tests;
mod perception;
mod route;
mod scanner;
mod supervise;
mod velocity;
mod velocity_base;

pub use advise::PERSON_PROBABILITY_MIN;
pub use bus_base::{BaseKinematics, BusBase};
pub use buttons::BusWithButtons;
pub use can::can_bus;
pub use imu::imu_input;
pub use inputs::{
    GuardInput, advice_input, command_input, observed_advice_input, observed_command_input,
    observed_operator_input, operator_input, shaped_command_input,
};
pub use lidar::lidar_input;
pub use mission::{Mission, MissionMoment, drive_mission};
pub use perception::{FindPeopleByLegs, JudgeMotion, NoMotion, PerceptionState, follow_legs, perceive};
pub use route::drive_route;
pub use scanner::{
    SEARCHED_STEP_RAD, ranging_datagrams, ranging_scanner, rear_scanner_input, scanner_datagrams,
    scanner_input,
};
pub use supervise::supervise;
pub use velocity::{VelocityRules, velocity_input};
pub use velocity_base::velocity_base;
