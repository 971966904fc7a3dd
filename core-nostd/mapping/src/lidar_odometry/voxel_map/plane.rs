//! A plane through the returns of a cube.

use nalgebra::Vector3;

use super::eigen::symmetric_eigen;
use super::voxel::Sums;

/// A plane and how well it is known. [`Plane::NONE`] is known not at all.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Plane {
    /// Unit vector; its sign has no meaning.
    pub normal: Vector3<f32>,
    /// A point of the plane, metres in the map.
    pub mean: Vector3<f32>,
    /// Variance of the returns about the plane plus that of its middle, m²; negative: there is no plane.
    pub variance: f32,
    /// What the tilt adds to the variance for each square metre of distance from the middle.
    pub tilt: f32,
}

/// The narrower side of the returns must be this share of the edge (standard deviation), or they lie on a line.
const WIDTH_LEAST: f32 = 0.10;
/// The variance across the plane may be this share of that along its narrower side.
const FLATNESS: f32 = 0.10;

impl Plane {
    /// No plane.
    pub const NONE: Self = Self {
        normal: Vector3::new(0.0, 0.0, 0.0),
        mean: Vector3::new(0.0, 0.0, 0.0),
        variance: -1.0,
        tilt: 0.0,
    };

    /// Whether there is one.
    #[inline]
    #[must_use]
    pub fn is_known(&self) -> bool {
        self.variance >= 0.0
    }

    /// Through returns whose sums are about `middle`, a cube's; [`Plane::NONE`] where they lie on a line or fill the cube.
    pub(super) fn of(sums: &Sums, middle: &Vector3<f32>, edge_m: f32) -> Self {
        let count = f32::from(sums.count.max(1));
        let mean = sums.sum / count;
        let part = |square: f32, a: f32, b: f32| square / count - a * b;
        let [xx, xy, xz, yy, yz, zz] = sums.square;
        let eigen = symmetric_eigen([
            part(xx, mean.x, mean.x),
            part(xy, mean.x, mean.y),
            part(xz, mean.x, mean.z),
            part(yy, mean.y, mean.y),
            part(yz, mean.y, mean.z),
            part(zz, mean.z, mean.z),
        ]);
        let [across, narrow, _] = eigen.values;
        let across = across.max(0.0);
        let width = WIDTH_LEAST * edge_m;
        if !(narrow > width * width && across < FLATNESS * narrow) {
            return Self::NONE;
        }
        let [normal, ..] = eigen.vectors;
        Self {
            normal,
            mean: middle + mean,
            variance: across * (1.0 + 1.0 / count),
            tilt: across / (count * narrow),
        }
    }
}
