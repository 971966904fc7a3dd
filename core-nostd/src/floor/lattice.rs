//! A fixed lattice of pixels: enough of them to fit a plane, few enough to count.
//!
//! Nothing is copied: every pass walks over the same pixels of the borrowed image again.

use crate::sensing::{DepthImage, PinholeCamera};

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

    /// The points of each row of the lattice, from the row `skipped` × the height of the image on.
    pub(super) fn rows(
        &self,
        skipped: f32,
    ) -> impl Iterator<Item = impl Iterator<Item = [f32; 3]> + use<'a>> + use<'a> {
        let Self { image, camera, stride } = *self;
        let first = ((image.height() as f32 * skipped) as usize).saturating_add(stride / 2);
        image.rows().enumerate().skip(first).step_by(stride.max(1)).map(move |(row, depths)| {
            let [_, ray_y, _] = camera.ray(0.0, row as f32);
            depths.iter().enumerate().skip(stride / 2).step_by(stride.max(1)).filter_map(
                move |(column, depth)| {
                    let z = f32::from(*depth) * 0.001;
                    let [ray_x, _, _] = camera.ray(column as f32, 0.0);
                    (z > NEAREST_M && z < FARTHEST_M).then_some([z * ray_x, z * ray_y, z])
                },
            )
        })
    }
}
