//! The camera's model in double precision.

use nalgebra::{Vector2, Vector3};

/// Focal lengths, principal point and lens (Brown 1966; coefficients of OpenCV).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CameraIntrinsics {
    /// Along columns and rows, pixels.
    pub focal_px: [f64; 2],
    /// Of the optical axis, pixels.
    pub centre_px: [f64; 2],
    /// k1, k2, k3.
    pub radial: [f64; 3],
    /// p1, p2.
    pub tangential: [f64; 2],
}

/// Rounds in which the distortion is undone; each shrinks the error by the slope of the distortion.
const ROUNDS: usize = 40;

impl CameraIntrinsics {
    /// Pixel of a point of the camera's frame (x right, y down, z forward); `None` behind the camera.
    #[must_use]
    pub fn project(&self, point: &Vector3<f64>) -> Option<Vector2<f64>> {
        // Also false for a NaN.
        let is_before = point.z > 1.0e-3;
        if !is_before {
            return None;
        }
        let distorted = self.distort(Vector2::new(point.x / point.z, point.y / point.z));
        let [fx, fy] = self.focal_px;
        let [cx, cy] = self.centre_px;
        Some(Vector2::new(fx * distorted.x + cx, fy * distorted.y + cy))
    }

    fn distort(&self, at: Vector2<f64>) -> Vector2<f64> {
        let (x, y) = (at.x, at.y);
        let squared = x * x + y * y;
        let [k1, k2, k3] = self.radial;
        let [p1, p2] = self.tangential;
        let radial = 1.0 + squared * (k1 + squared * (k2 + squared * k3));
        Vector2::new(
            x * radial + 2.0 * p1 * x * y + p2 * (squared + 2.0 * x * x),
            y * radial + p1 * (squared + 2.0 * y * y) + 2.0 * p2 * x * y,
        )
    }

    /// Direction of a pixel at z = 1, without the lens's distortion.
    #[must_use]
    pub fn undistorted(&self, pixel: Vector2<f64>) -> Vector2<f64> {
        let [fx, fy] = self.focal_px;
        let [cx, cy] = self.centre_px;
        let seen = Vector2::new((pixel.x - cx) / fx, (pixel.y - cy) / fy);
        let mut at = seen;
        for _ in 0..ROUNDS {
            at -= self.distort(at) - seen;
        }
        at
    }
}
