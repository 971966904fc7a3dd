//! `robot.toml`: read strictly, refused with file, line, the limit broken and a remedy.

mod absent;
mod actuated_lidar;
mod address;
mod asked;
mod bake;
mod base;
mod bridged_scanner;
mod camera;
mod command;
mod coverage;
mod devices;
mod distinct;
mod fields;
mod fleet;
mod learning;
mod lidar;
mod limits;
mod mission;
mod motors;
mod navigation;
mod panel;
mod polygon;
mod problem;
mod read;
mod reader;
mod reference;
mod ros2;
mod scanner;
mod sensors;
mod warnings;
mod wheels;

pub use absent::{Absence, absences};
pub use actuated_lidar::{ActuatedLidarConfiguration, ScipModel};
pub use address::{
    BaseAddress, CanAddress, DatagramAddress, ImuAddress, ScannerAddress, ScipAddress, SenderAddress,
    SerialAddress,
};
pub use bake::bake;
pub use bridged_scanner::{BRIDGED_EXAMPLE, bridged_scanner_keys};
pub use camera::{CameraConfiguration, CameraSource};
pub use command::{CommandAddress, CommandConfiguration};
pub use coverage::{
    AcceptedGap, BAR_M, Coverage, Direction, DirectionLimit, Gap, GapMotion, GapSpeed, HEIGHTS_M, Motion,
    Refusal, Region, SensorGap, Sight, SpeedStep, Unseen,
};
pub use fleet::FleetConfiguration;
pub use learning::LearningConfiguration;
pub use lidar::{bridged_keys, livox_keys, ouster_example, ouster_format, ouster_keys};
pub use mission::{CleaningStrategy, MissionConfiguration};
pub use navigation::{NavigationConfiguration, NavigationPlanner};
pub use panel::{Consumable, LevelBits, OtherRobot, PanelConfiguration};
pub use polygon::contains as polygon_contains;
pub use problem::{Problem, Refused, did_you_mean};
pub use read::{Carriers, HostedConfiguration, RecordedConfiguration, load, parse, parse_recorded};
pub use reference::reference;
pub use ros2::{RosConfiguration, RosTopic};

/// The example configuration at the root of the workspace; the simulated robot is built like this.
pub const EXAMPLE: &str = include_str!("../../../robot.toml");
