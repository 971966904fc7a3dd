//! The motion during a sweep: three angles and a step, of which a return sees the share that has passed when it comes.

use floorguard_mapping::lidar_odometry::Pose3;
use nalgebra::{Matrix3, Vector3};

use super::features::Feature;

/// From the end of a sweep to its start. Applied to a return, angles and step count with the share of its time.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct SweepStep {
    /// About x, y and z, radians; z is turned last.
    pub(super) angles_rad: Vector3<f64>,
    /// Metres.
    pub(super) step_m: Vector3<f64>,
}

/// Turns about x, then y, then z.
fn rotation(angles_rad: &Vector3<f64>) -> Matrix3<f64> {
    let [(sr, cr), (sp, cp), (sy, cy)] = [angles_rad.x, angles_rad.y, angles_rad.z].map(libm::sincos);
    Matrix3::new(
        cy * cp,
        cy * sp * sr - sy * cr,
        cy * sp * cr + sy * sr,
        sy * cp,
        sy * sp * sr + cy * cr,
        sy * sp * cr - cy * sr,
        -sp,
        cp * sr,
        cp * cr,
    )
}

impl SweepStep {
    /// The frame of the end in that of the start.
    pub(super) fn pose(&self) -> Pose3 {
        Pose3 { rotation: rotation(&self.angles_rad), place_m: self.step_m }
    }

    /// The turned return without the step, and with it: in the frame of the start.
    pub(super) fn to_start(self, feature: &Feature) -> [Vector3<f64>; 2] {
        let share = f64::from(feature.time_share);
        let turned = rotation(&(self.angles_rad * share)) * feature.point.map(f64::from);
        [turned, turned + self.step_m * share]
    }

    /// A return in the frame of the end.
    pub(super) fn to_end(self, feature: &Feature) -> Feature {
        let [_, at_start] = self.to_start(feature);
        let pose = self.pose();
        let at_end = pose.rotation.transpose() * (at_start - pose.place_m);
        Feature { point: at_end.map(|value| value as f32), ..*feature }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn straightened_returns_move_with_their_time() {
        let step =
            SweepStep { angles_rad: Vector3::new(0.01, -0.02, 0.3), step_m: Vector3::new(0.1, 0.05, 0.0) };
        let at = |time_share: f32| Feature { point: Vector3::new(5.0, 1.0, 0.5), row: 3, time_share };
        assert!((step.to_end(&at(1.0)).point - at(1.0).point).norm() < 1.0e-5);
        let first = step.to_end(&at(0.0)).point.map(f64::from);
        assert!((step.pose().transform(&first) - Vector3::new(5.0, 1.0, 0.5)).norm() < 1.0e-5);
        let vector = step.pose().rotation_vector();
        assert!((vector.z - 0.3).abs() < 0.01, "{vector}");
    }
}
