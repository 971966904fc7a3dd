//! What every pixel of a depth image is: floor, something on it, a hole — or unknown, which is none of them.
//!
//! A pixel is an object where it is higher than the noise of its height can explain. What a camera does not see is
//! never floor. Source: algorithms E.3.

use super::curvature::Curvature;
use super::model::FloorParameters;
use super::plane::{Plane, dot};

/// The class of a pixel.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum PixelClass {
    /// No depth, or a lonely pixel of another height than all around it: nobody knows.
    #[default]
    Unknown,
    /// In the floor.
    Floor,
    /// Higher than floor can be.
    Object,
    /// Lower than floor can be: an edge, or a mirror image in wet floor.
    Hole,
    /// Beyond the working range: not looked at.
    Far,
}

/// Least height of an object pixel, metres.
const OBJECT_MIN_M: f32 = 0.01;
/// Least depth of a hole pixel, metres.
const HOLE_MIN_M: f32 = 0.02;
/// Heights beyond this many standard deviations are not noise: one pixel in 30,000 is, if noise is Gaussian.
const SIGMAS: f32 = 4.0;

/// One pixel's class and height.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Judged {
    pub class: PixelClass,
    pub height_m: f32,
}

/// Judges the pixels of one row after another.
#[derive(Clone, Copy)]
pub(super) struct Judge {
    parameters: FloorParameters,
    plane: Plane,
    curvature: Option<Curvature>,
}

impl Judge {
    pub(super) fn new(parameters: &FloorParameters, plane: &Plane, curvature: &Curvature) -> Self {
        Self {
            parameters: *parameters,
            plane: *plane,
            curvature: Some(*curvature).filter(Curvature::is_bent),
        }
    }

    /// Judges a row into `judged`; both have the width of the image.
    pub(super) fn row(&self, row: usize, depths: &[u16], judged: &mut [Judged]) {
        let camera = self.parameters.camera;
        let [_, ray_y, _] = camera.ray(0.0, row as f32);
        for ((column, depth), judged) in depths.iter().enumerate().zip(judged) {
            let [ray_x, _, _] = camera.ray(column as f32, 0.0);
            *judged = self.pixel(*depth, [ray_x, ray_y, 1.0]);
        }
    }

    #[inline]
    fn pixel(&self, depth_mm: u16, ray: [f32; 3]) -> Judged {
        let z = f32::from(depth_mm) * 0.001;
        let along_ray = dot(self.plane.normal, ray);
        let mut height_m = z * along_ray + self.plane.distance_m;
        if let Some(curvature) = &self.curvature {
            height_m -= curvature.height_m(ray.map(|value| value * z));
        }
        // Squares are compared, so that no pixel needs a root.
        let variance = self.parameters.noise.variance_m2(z) * along_ray * along_ray;
        let exceeds_noise = height_m * height_m > SIGMAS * SIGMAS * variance;
        let class = if depth_mm == 0 {
            PixelClass::Unknown
        } else if z > self.parameters.working_range_m {
            PixelClass::Far
        } else if exceeds_noise && height_m > OBJECT_MIN_M {
            PixelClass::Object
        } else if exceeds_noise && height_m < -HOLE_MIN_M {
            PixelClass::Hole
        } else {
            PixelClass::Floor
        };
        Judged { class, height_m }
    }
}
