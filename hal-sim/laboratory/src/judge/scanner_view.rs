//! Where the scanners of a robot look: by the devices that are mounted, whatever sector the robot's file names.

use floorguard_sim::robot::{RobotParameters, ScannerDevice, SensorMount};
use floorguard_types::geometry::{Point2, Pose2};

use super::true_world::plane_of;

/// A scanner in the robot frame.
#[derive(Clone, Copy, Debug)]
pub(super) struct ScannerView {
    mount: SensorMount,
    /// It measures so far to either side of its front, radians.
    half_angle_rad: f32,
}

impl ScannerView {
    /// Of all scanners of a robot; one at the rear is an S300.
    pub(super) fn all(parameters: &RobotParameters) -> Vec<Self> {
        let front = Self::of(parameters.scanner, parameters.scanner_device);
        let rear = parameters.rear_scanner.map(|mount| Self::of(mount, ScannerDevice::S300));
        [front].into_iter().chain(rear).collect()
    }

    fn of(mount: SensorMount, device: ScannerDevice) -> Self {
        let (half_deg, _) = plane_of(device);
        Self { mount, half_angle_rad: half_deg.to_radians() }
    }

    /// A point lies within its plane's angle.
    pub(super) fn covers(&self, point: Point2) -> bool {
        let to_scanner = Pose2::new(self.mount.x_m, self.mount.y_m, self.mount.yaw_rad).inverse();
        let there = to_scanner.transform(point);
        there.y_m.atan2(there.x_m).abs() <= self.half_angle_rad
    }
}
