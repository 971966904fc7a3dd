//! Everything that can decide to move or stop, and nothing else.
//!
//! The rule of the room: at most 1,200 code lines, no decision with more than four conditions, a truth table for each,
//! and a requirement identifier (`FG-REQ-…`, listed in `docs/requirements.md`) at each rule and each test.

mod action;
mod advice;
mod cause;
mod collision;
mod config;
mod config_error;
mod decide;
mod decision;
mod field;
mod field_selection;
mod kinematics;
mod limiter;
mod machine;
mod motion_checks;
mod packet_check;
mod record;
mod scan_check;
mod source;
mod source_monitor;
mod state;
mod supervisor;
#[cfg(test)]
mod tests;

pub use action::{Action, GuardState};
pub use advice::{ADVISED_PEOPLE_MAX, Advice, AdvisedPerson};
pub use cause::{CAUSES, Cause, Clear, Escape};
pub use collision::{Body, time_to_collision_s};
pub use config::{DriveLimits, FieldSet, GuardConfig, LidarGeometry, ScannerGeometry, Thresholds, Travel};
pub use config_error::GuardConfigError;
pub use decision::{Decision, SourceReport};
pub use field::{Polygon, point_in_polygon, ray_exit_m};
pub use kinematics::{field_length_m, stop_distance_m};
pub use machine::{DecisionMachine, Verdict};
pub use record::{CauseRecord, Unit};
pub use source::{FaultKind, Health, Source, SourceRules};
pub use source_monitor::SourceMonitor;
pub use supervisor::Supervisor;
