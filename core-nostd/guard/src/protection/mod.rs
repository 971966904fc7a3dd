//! What the guard knows and how it speaks: configuration, precomputed field tables, geometry, and the vocabulary of
//! sources, causes and records. Nothing here decides; the rules are in `guard`.

mod action;
mod advice;
mod cause;
mod collision;
mod config;
mod config_error;
mod content_watch;
mod decision;
mod field;
mod floor_sight;
mod held;
mod integrity;
mod kinematics;
mod lidar_evidence;
mod lidar_rays;
mod local_memory;
mod memory_obstacles;
mod memory_row;
mod memory_window;
#[cfg(test)]
mod memory_window_tests;
mod motion;
mod never_seen;
#[cfg(test)]
mod never_seen_tests;
mod packet_table;
mod persistence;
mod rear_scanner;
mod receding;
mod record;
mod reset;
mod scan_evidence;
mod scan_table;
mod source;
mod standstill;
mod sweep;
mod swept_outline;
mod unseen_limits;

pub use action::{Action, GuardState};
pub use advice::{ADVISED_PEOPLE_MAX, Advice, AdvisedPerson};
pub use cause::{CAUSES, Cause};
pub use collision::{Blocked, Body, time_to_collision_s};
pub use config::{DriveLimits, FieldSet, GuardConfig, LidarGeometry, ScannerGeometry, Thresholds, Travel};
pub use config_error::GuardConfigError;
pub use content_watch::{ContentWatch, Repetition};
pub use decision::{Decision, SourceReport};
pub use field::{Polygon, point_in_polygon, ray_exit_m};
pub use floor_sight::{
    FLOOR_OBSTACLES_MAX, FloorLimits, FloorObstacle, FloorSight, OBSTACLE_HEIGHT_MIN_M, SIGHT_MAX_US,
    with_floor,
};
pub use held::{HeldCause, HeldCauses};
pub use integrity::{Integrity, PARTS};
pub use kinematics::{field_length_m, stop_distance_m};
pub use lidar_rays::LidarRays;
pub use local_memory::{Cell, LocalMemory};
pub use memory_obstacles::Sight;
#[cfg(test)]
pub(crate) use memory_row::Row;
pub use motion::Motion;
pub use never_seen::Blind;
pub use packet_table::PacketTable;
pub(crate) use packet_table::{BIN_CDEG, Bin};
pub use persistence::Persistence;
pub use rear_scanner::RearScanner;
pub use record::{CauseRecord, Unit};
pub use reset::{ResetRefusal, ResetReport};
pub use scan_table::ScanTable;
pub use source::{FaultKind, Health, Source, SourceRules};
pub use standstill::{CREEP_M, Creep};
pub use sweep::{
    BRAKE_WEAR, MARGIN_M, REACTION_S, STANDOFF_M, Stopping, Sweep, fastest_mps, signed_distance_m,
};
pub use swept_outline::{BEND_PER_M, OVERSPEED_SHARE, Zone, contains, swept_outline};
pub use unseen_limits::{SeenBeside, UnseenLimits};
