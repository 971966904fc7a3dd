//! A camera without distortion: which ray each pixel looks along.

/// Intrinsics of a rectified camera, in pixels. Camera frame: x right, y down, z forward (book, Conventions: Frames and
/// units). Invariants: all finite, both focal lengths ≥ 1.
///
/// ```
/// use floorguard_types::sensing::{PinholeCamera, Pixel};
///
/// let camera = PinholeCamera::new([525.0, 525.0], [319.5, 239.5]).unwrap();
/// let [x, y, z] = camera.ray(100.0, 400.0);
/// let Pixel { column, row } = camera.project([2.0 * x, 2.0 * y, 2.0 * z]).unwrap();
/// assert!((column - 100.0).abs() < 1.0e-3 && (row - 400.0).abs() < 1.0e-3);
/// assert_eq!(camera.project([0.0, 0.0, -1.0]), None);
/// assert!(PinholeCamera::new([0.0, 525.0], [319.5, 239.5]).is_none());
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PinholeCamera {
    focal_px: [f32; 2],
    centre_px: [f32; 2],
}

/// A place in a picture, in pixels from the middle of the first one; may lie outside.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pixel {
    /// To the right.
    pub column: f32,
    /// Down.
    pub row: f32,
}

impl PinholeCamera {
    /// From focal lengths and principal point, pixels. `None` for a number that is not finite, a focal length below
    /// one pixel or a value beyond 10⁶: such a camera was never calibrated.
    #[must_use]
    pub fn new(focal_px: [f32; 2], centre_px: [f32; 2]) -> Option<Self> {
        let plausible = focal_px.iter().all(|focal| (1.0..1.0e6).contains(focal))
            && centre_px.iter().all(|centre| centre.abs() < 1.0e6);
        plausible.then_some(Self { focal_px, centre_px })
    }

    /// Focal lengths along columns and rows, pixels.
    #[must_use]
    pub const fn focal_px(&self) -> [f32; 2] {
        self.focal_px
    }

    /// Column and row of the optical axis, pixels.
    #[must_use]
    pub const fn centre_px(&self) -> [f32; 2] {
        self.centre_px
    }

    /// The same camera after its images were made smaller by a whole factor ≥ 1.
    ///
    /// ```
    /// use floorguard_types::sensing::{PinholeCamera, Pixel};
    ///
    /// let camera = PinholeCamera::new([525.0, 525.0], [319.5, 239.5]).unwrap();
    /// assert_eq!(camera.shrunk(4).focal_px(), [131.25, 131.25]);
    /// assert_eq!(camera.shrunk(4).centre_px(), [79.5, 59.5]);
    /// ```
    #[must_use]
    pub fn shrunk(&self, factor: u16) -> Self {
        let scale = 1.0 / f32::from(factor.max(1));
        let [fx, fy] = self.focal_px;
        let [cx, cy] = self.centre_px;
        Self {
            focal_px: [(fx * scale).max(1.0), (fy * scale).max(1.0)],
            centre_px: [(cx + 0.5) * scale - 0.5, (cy + 0.5) * scale - 0.5],
        }
    }

    /// The ray of a pixel with z = 1: a point at depth `z` is `z` times this ray.
    #[inline]
    #[must_use]
    pub fn ray(&self, column: f32, row: f32) -> [f32; 3] {
        let [fx, fy] = self.focal_px;
        let [cx, cy] = self.centre_px;
        [(column - cx) / fx, (row - cy) / fy, 1.0]
    }

    /// Where a point in front of the camera appears; `None` at or behind it.
    #[must_use]
    pub fn project(&self, point: [f32; 3]) -> Option<Pixel> {
        let [x, y, z] = point;
        let [fx, fy] = self.focal_px;
        let [cx, cy] = self.centre_px;
        (z > 1.0e-6).then(|| Pixel { column: fx * x / z + cx, row: fy * y / z + cy })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rays_and_projections_agree() {
        let camera = PinholeCamera::new([525.0, 520.0], [319.5, 239.5]).unwrap();
        let [x, y, z] = camera.ray(100.0, 400.0);
        let Pixel { column, row } = camera.project([2.0 * x, 2.0 * y, 2.0 * z]).unwrap();
        assert!((column - 100.0).abs() < 1e-3 && (row - 400.0).abs() < 1e-3);
        assert_eq!(camera.project([0.0, 0.0, 0.0]), None);
        let [x, y, _] = camera.shrunk(4).ray(79.375, 59.375);
        assert!(x.abs() < 1e-3 && y.abs() < 1e-3);
    }

    #[test]
    fn uncalibrated_cameras_are_refused() {
        for focal in [0.0, -525.0, f32::NAN, f32::INFINITY] {
            assert!(PinholeCamera::new([focal, 525.0], [0.0, 0.0]).is_none());
        }
        assert!(PinholeCamera::new([525.0, 525.0], [f32::NAN, 0.0]).is_none());
    }
}
