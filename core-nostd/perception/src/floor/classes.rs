//! What every pixel of a depth image is: floor, something on it, a hole — or unknown, which is none of them.
//!
//! A pixel is an object where it is higher than the noise of its height can explain. What a camera does not see is
//! never floor. Source: book, Floor and dirt: Objects.

use super::curvature::Curvature;
use super::model::FloorParameters;
use super::plane::Plane;
use floorguard_types::number::nearest_f32;
use floorguard_types::profile::{Entry, Profile, Table, TableOf};

/// The class of a pixel.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum PixelClass {
    /// No depth, or a lonely pixel of another height than all around it: unknown.
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

/// Judges the pixels of one row after another.
pub(super) struct Judge<P: Profile> {
    parameters: FloorParameters,
    plane: Plane,
    curvature: Option<Curvature>,
    /// The first component of every column's ray.
    rays_x: TableOf<f32, P::FloorColumns>,
}

impl Entry for PixelClass {
    const BLANK: Self = Self::Unknown;
}

impl<P: Profile> Judge<P> {
    pub(super) fn new(parameters: &FloorParameters, plane: &Plane, curvature: &Curvature) -> Self {
        let mut rays_x = <TableOf<f32, P::FloorColumns>>::BLANK;
        for (column, slot) in rays_x.iter_mut().enumerate() {
            [*slot, _, _] = parameters.camera.ray(nearest_f32(column), 0.0);
        }
        let curvature = Some(*curvature).filter(Curvature::is_bent);
        Self { parameters: *parameters, plane: *plane, curvature, rays_x }
    }

    /// Judges a row into `classes`; both have the width of the image, at most the profile's.
    pub(super) fn row(&self, row: usize, depths: &[u16], classes: &mut [PixelClass]) {
        // Distinguished once a row, so that the loop over the pixels has no branch and compilers vectorise
        // it.
        let [_, ray_y, _] = self.parameters.camera.ray(0.0, nearest_f32(row));
        match self.curvature.as_ref().map(|curvature| curvature.row(ray_y)) {
            None => self.row_over(ray_y, depths, classes, |_, _| 0.0),
            Some(floor) => self.row_over(ray_y, depths, classes, |z, ray_x| floor.height_m(z, ray_x)),
        }
    }

    #[inline]
    fn row_over(
        &self,
        ray_y: f32,
        depths: &[u16],
        classes: &mut [PixelClass],
        floor_m: impl Fn(f32, f32) -> f32,
    ) {
        let Self { parameters: FloorParameters { noise, working_range_m, .. }, plane, .. } = self;
        let [nx, ny, nz] = plane.normal;
        let along_row = ny * ray_y + nz;
        for ((depth, ray_x), class) in depths.iter().zip(self.rays_x.iter()).zip(classes) {
            let z = f32::from(*depth) * 0.001;
            let along_ray = nx * ray_x + along_row;
            let height_m = z * along_ray + plane.distance_m - floor_m(z, *ray_x);
            // Squares are compared, so that no pixel needs a root.
            let variance = noise.variance_m2(z) * along_ray * along_ray;
            let exceeds_noise = height_m * height_m > SIGMAS * SIGMAS * variance;
            let mut found = PixelClass::Floor;
            found = if exceeds_noise & (height_m > OBJECT_MIN_M) { PixelClass::Object } else { found };
            found = if exceeds_noise & (height_m < -HOLE_MIN_M) { PixelClass::Hole } else { found };
            found = if z > *working_range_m { PixelClass::Far } else { found };
            *class = if *depth == 0 { PixelClass::Unknown } else { found };
        }
    }

    /// Height of a pixel above the floor, metres.
    #[inline]
    pub(super) fn above_floor_m(&self, point: [f32; 3]) -> f32 {
        let floor_m = self.curvature.as_ref().map_or(0.0, |curvature| curvature.height_m(point));
        self.plane.height_m(point) - floor_m
    }
}
