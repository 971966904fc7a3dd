//! Where a lidar point appears in a picture that has not been rectified.

use floorguard_types::geometry::{Point3, Transform3};
use floorguard_types::number::nearest_f32;
use floorguard_types::sensing::{PinholeCamera, Pixel};

use super::calibration::{CalibrationError, checked_mounting};

/// Distortion of a lens (Brown 1966), coefficients in the order of OpenCV: k1, k2, p1, p2, k3.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct BrownLens {
    /// Radial, of the 2nd, 4th and 6th power of the distance from the axis.
    pub radial: [f32; 3],
    /// Tangential.
    pub tangential: [f32; 2],
}

/// A camera beside a lidar: intrinsics, lens, and where the lidar is seen from it.
///
/// ```
/// use floorguard_mapping::people_removal::{BrownLens, LensCamera};
/// use floorguard_types::geometry::{Point3, Transform3};
/// use floorguard_types::sensing::PinholeCamera;
///
/// // Camera axes: x right, y down, z forward; the lidar looks along x and stands in the same place.
/// let camera_from_lidar = Transform3 {
///     rotation: [[0.0, -1.0, 0.0], [0.0, 0.0, -1.0], [1.0, 0.0, 0.0]],
///     translation: Point3::new(0.0, 0.0, 0.0),
/// };
/// let pinhole = PinholeCamera::new([500.0, 500.0], [320.0, 240.0]).unwrap();
/// let camera = LensCamera::new(pinhole, BrownLens::default(), camera_from_lidar)?;
/// let pixel = camera.project(Point3::new(5.0, 1.0, 0.5)).unwrap();
/// assert_eq!((pixel.column, pixel.row), (220.0, 190.0));
/// assert_eq!(camera.project(Point3::new(-5.0, 1.0, 0.5)), None);
/// # Ok::<(), floorguard_mapping::people_removal::CalibrationError>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LensCamera {
    pinhole: PinholeCamera,
    lens: BrownLens,
    camera_from_lidar: Transform3,
    /// Square of the distance from the axis, at z = 1, from which on the polynomial folds back.
    fold_squared: f32,
}

/// Nearer points are not in the picture, metres along the optical axis.
const DEPTH_MIN_M: f32 = 0.1;
/// Beyond this distance from the axis at z = 1, in x or in y, no lens of this model is calibrated (56°).
const SIDE_MAX: f32 = 1.5;
/// Places at which the slope of the radial polynomial is looked at.
const SLOPE_STEPS: u16 = 512;

impl LensCamera {
    /// A camera. `camera_from_lidar` takes points of the lidar's frame to that of the camera (x right, y down, z forward).
    ///
    /// # Errors
    /// The transform is no rigid one, or a coefficient is beyond reason.
    pub fn new(
        pinhole: PinholeCamera,
        lens: BrownLens,
        camera_from_lidar: Transform3,
    ) -> Result<Self, CalibrationError> {
        let plausible = |value: &f32| value.is_finite() && libm::fabsf(*value) <= 100.0;
        if !(lens.radial.iter().all(plausible) && lens.tangential.iter().all(plausible)) {
            return Err(CalibrationError::Lens);
        }
        let camera_from_lidar = checked_mounting(camera_from_lidar)?;
        Ok(Self { pinhole, lens, camera_from_lidar, fold_squared: fold_squared(lens.radial) })
    }

    /// Pixel of a point of the lidar's frame; `None` behind the camera, nearer than 0.1 m, or where the lens model folds
    /// back: there a point outside of the picture would appear inside.
    #[must_use]
    pub fn project(&self, point_in_lidar: Point3) -> Option<Pixel> {
        let point = self.camera_from_lidar.transform(point_in_lidar);
        // Also false for a NaN.
        let is_before = point.z_m > DEPTH_MIN_M;
        if !is_before {
            return None;
        }
        let (x, y) = (point.x_m / point.z_m, point.y_m / point.z_m);
        let squared = x * x + y * y;
        let is_inside =
            libm::fabsf(x) <= SIDE_MAX && libm::fabsf(y) <= SIDE_MAX && squared < self.fold_squared;
        if !is_inside {
            return None;
        }
        let [k1, k2, k3] = self.lens.radial;
        let [p1, p2] = self.lens.tangential;
        let radial = 1.0 + squared * (k1 + squared * (k2 + squared * k3));
        let distorted_x = x * radial + 2.0 * p1 * x * y + p2 * (squared + 2.0 * x * x);
        let distorted_y = y * radial + p1 * (squared + 2.0 * y * y) + 2.0 * p2 * x * y;
        self.pinhole.project([distorted_x, distorted_y, 1.0])
    }
}

/// Where the distorted distance r·(1 + k1 r² + k2 r⁴ + k3 r⁶) stops growing with r.
fn fold_squared(radial: [f32; 3]) -> f32 {
    let [k1, k2, k3] = radial;
    let end = 2.0 * SIDE_MAX * SIDE_MAX;
    for step in 1..=SLOPE_STEPS {
        let s = end * nearest_f32(step) / nearest_f32(SLOPE_STEPS);
        let slope = 1.0 + s * (3.0 * k1 + s * (5.0 * k2 + s * 7.0 * k3));
        if slope <= 0.0 {
            return end * nearest_f32(step.saturating_sub(1)) / nearest_f32(SLOPE_STEPS);
        }
    }
    f32::INFINITY
}
