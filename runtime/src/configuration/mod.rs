//! What one `robot.toml` says, as plain data. Hosted it is read and checked at start; for the MCU a build script
//! checks the same file and bakes it into a constant.

mod fields;
mod guard;
mod lidar;
mod ranging;
mod robot;
mod sources;

pub use fields::{DirectionOfTravel, FIELD_SPEED_BINS, FieldPair, Polygon};
pub use ranging::{RangingGeometry, RangingModel};
pub use robot::{BaseKind, Deadlines, DriveTrain, Geometry, Limits, RobotConfiguration};
pub use sources::{
    CanConfiguration, ImuConfiguration, ImuModel, LidarConfiguration, LidarModel, Mounting, OperatorButtons,
    ScannerConfiguration, ScannerModel,
};
