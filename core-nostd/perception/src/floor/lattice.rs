//! A fixed lattice of pixels: enough of them to fit a plane, few enough to count.
//!
//! Nothing is copied: every pass walks over the same pixels of the borrowed image again.

use super::lanes::{LANES, Lanes};
use floorguard_types::number::{nearest_f32, saturating_usize};
use floorguard_types::sensing::{DepthImage, PinholeCamera};

/// Nearer than any of the cameras can measure, metres.
const NEAREST_M: f32 = 0.2;
/// Farther than a floor is of use, metres: there the steps of the depth are wider than the objects.
const FARTHEST_M: f32 = 8.0;

/// The lattice of an image.
#[derive(Clone, Copy)]
pub(super) struct Lattice<'a> {
    image: DepthImage<'a>,
    camera: PinholeCamera,
    stride: usize,
}

impl<'a> Lattice<'a> {
    /// About `columns` pixels a row, with the same spacing down the image.
    pub(super) fn new(image: DepthImage<'a>, camera: PinholeCamera, columns: u16) -> Self {
        let stride = image.width().checked_div(usize::from(columns)).unwrap_or(1).max(1);
        Self { image, camera, stride }
    }

    /// How many pixels the lattice has, with or without a return.
    pub(super) fn size(&self) -> usize {
        let along = |side: usize| side.saturating_sub(self.stride / 2).div_ceil(self.stride.max(1));
        along(self.image.width()).saturating_mul(along(self.image.height()))
    }

    /// The points of the lattice with a return, from the row `skipped` × the height of the image on.
    pub(super) fn points(&self, skipped: f32) -> impl Iterator<Item = [f32; 3]> + use<'a> {
        let Self { image, camera, stride } = *self;
        let first = saturating_usize(nearest_f32(image.height()) * skipped).saturating_add(stride / 2);
        image.rows().enumerate().skip(first).step_by(stride.max(1)).flat_map(move |(row, depths)| {
            let sampled = depths.iter().enumerate().skip(stride / 2).step_by(stride.max(1));
            sampled.filter_map(move |(column, depth)| {
                let z = f32::from(*depth) * 0.001;
                let ray = camera.ray(nearest_f32(column), nearest_f32(row));
                (z > NEAREST_M && z < FARTHEST_M).then(|| ray.map(|value| value * z))
            })
        })
    }

    /// The same points row by row, four together, with or without a return.
    pub(super) fn rows(
        &self,
    ) -> impl Iterator<Item = impl Iterator<Item = LatticePoints> + use<'a>> + use<'a> {
        let Self { image, camera, stride } = *self;
        let (stride, half) = (stride.max(1), stride / 2);
        let [fx, _] = camera.focal_px();
        let [left, _, _] = camera.ray(nearest_f32(half), 0.0);
        let across = nearest_f32(stride) / fx;
        image.rows().enumerate().skip(half).step_by(stride).map(move |(row, depths)| {
            let [_, ray_y, _] = camera.ray(0.0, nearest_f32(row));
            let groups = depths.chunks(stride.saturating_mul(LANES).max(1)).enumerate();
            groups.map(move |(group, depths)| {
                let at = |lane: usize| depths.get(lane.wrapping_mul(stride).wrapping_add(half));
                let raw = [at(0), at(1), at(2), at(3)].map(|depth| depth.copied().unwrap_or(0));
                let place = nearest_f32(group.wrapping_mul(LANES));
                let columns = Lanes([place, place + 1.0, place + 2.0, place + 3.0]);
                let z = Lanes(raw.map(|depth| f32::from(depth) * 0.001));
                let is_return = Lanes::all(NEAREST_M).is_below(z) * z.is_below(Lanes::all(FARTHEST_M));
                LatticePoints { ray_x: columns * across + left, ray_y, z, is_return }
            })
        })
    }
}

/// Four neighbours of a row of the lattice.
#[derive(Clone, Copy)]
pub(super) struct LatticePoints {
    ray_x: Lanes,
    ray_y: f32,
    /// Depths, metres.
    pub(super) z: Lanes,
    /// 1 where a usable depth came back, else 0.
    pub(super) is_return: Lanes,
}

impl LatticePoints {
    /// Products of a direction with the rays, which have z = 1; times `z` they are products with the points.
    #[inline]
    pub(super) fn along_rays(&self, [x, y, z]: [f32; 3]) -> Lanes {
        self.ray_x * x + (y * self.ray_y + z)
    }
}
