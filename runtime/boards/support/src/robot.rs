//! Configuration, baked from `robot.toml` by the build script.

use floorguard_drivers::flexisoft::{InputBits, InputMap};
use floorguard_guard::{Action, Thresholds, UnseenLimits};
use floorguard_runtime::configuration::{
    BaseKind, CanConfiguration, Deadlines, DirectionOfTravel, DriveTrain, FieldPair, Geometry,
    ImuConfiguration, ImuModel, LidarConfiguration, LidarModel, Limits, Mounting, OperatorButtons,
    RobotConfiguration, ScannerConfiguration, ScannerModel,
};
use floorguard_runtime::mission::{Route, RouteLimits};
use floorguard_types::geometry::{Point2, Point3};

/// A list with a capacity; the build script has checked that it fits.
fn list<T: Clone, const N: usize>(elements: &[T]) -> heapless::Vec<T, N> {
    elements.iter().cloned().collect()
}

include!(concat!(env!("OUT_DIR"), "/robot.rs"));
