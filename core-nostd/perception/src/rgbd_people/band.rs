//! Connected objects in the band of the legs, read row by row in fixed memory.
//!
//! Source: book, Depth people: Leg band. The published chain voxels the cloud, takes planes away and joins points
//! within 10 cm, which joins two legs that stand side by side; here neighbours in the picture belong together unless
//! their depths jump, so the floor seen between two legs keeps them apart, and a wall is one object that is too wide
//! for a leg.

use super::floor_frame::{FloorFrame, FloorPoint};
use super::parameters::RgbdParameters;
use floorguard_types::capacities::{FLOOR_IMAGE_COLUMNS_MAX, RGBD_LEG_PARTS_MAX};
use floorguard_types::number::nearest_f32;
use floorguard_types::profile::Of;
use floorguard_types::sensing::DepthImage;
use floorguard_types::united_parts::{Absorb, UnitedParts};

/// Pixels a row that are examined.
const LATTICE_COLUMNS: usize = 320;
/// Neighbours of one leg differ in depth by less than this and three standard deviations, metres.
const DEPTH_STEP_M: f32 = 0.03;
/// Heights beyond this many standard deviations are not floor.
const SIGMAS: f32 = 4.0;

/// An object in the band.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct BandPart {
    /// Least right, ahead and height, metres.
    pub low_m: [f32; 3],
    /// Greatest, the same.
    pub high_m: [f32; 3],
    /// Sums of right, ahead and depth, metres.
    pub sums_m: [f32; 3],
    /// Pixels examined.
    pub pixels: u32,
    /// Corner of its rectangle in the picture.
    pub first_px: [u16; 2],
    /// Opposite corner, included.
    pub last_px: [u16; 2],
}

impl Absorb for BandPart {
    fn absorb(&mut self, other: &Self) {
        for (low, value) in self.low_m.iter_mut().zip(other.low_m) {
            *low = low.min(value);
        }
        for (high, value) in self.high_m.iter_mut().zip(other.high_m) {
            *high = high.max(value);
        }
        for (sum, value) in self.sums_m.iter_mut().zip(other.sums_m) {
            *sum += value;
        }
        for (first, value) in self.first_px.iter_mut().zip(other.first_px) {
            *first = (*first).min(value);
        }
        for (last, value) in self.last_px.iter_mut().zip(other.last_px) {
            *last = (*last).max(value);
        }
        self.pixels = self.pixels.saturating_add(other.pixels);
    }
}

#[derive(Clone, Copy, Debug, Default)]
struct Above {
    part: Option<u16>,
    depth_m: f32,
}

/// Working memory of the reading.
#[derive(Clone, Debug)]
pub(super) struct Band {
    above: [Above; FLOOR_IMAGE_COLUMNS_MAX],
    parts: UnitedParts<BandPart, Of<RGBD_LEG_PARTS_MAX>>,
    /// Parts beyond the capacity.
    pub dropped: u32,
}

impl Default for Band {
    fn default() -> Self {
        Self { above: [Above::default(); FLOOR_IMAGE_COLUMNS_MAX], parts: UnitedParts::default(), dropped: 0 }
    }
}

impl Band {
    /// Reads the band of a picture.
    pub(super) fn read(&mut self, image: &DepthImage<'_>, frame: &FloorFrame, parameters: &RgbdParameters) {
        self.parts.clear();
        self.dropped = 0;
        self.above = [Above::default(); FLOOR_IMAGE_COLUMNS_MAX];
        let stride = (image.width() / LATTICE_COLUMNS).max(1);
        for (row, depths) in image.rows().enumerate().step_by(stride) {
            let rays = frame.row(row);
            let gain = frame.height_gain(0.5 * nearest_f32(image.width()), nearest_f32(row));
            let mut left = Above::default();
            for (column, depth) in depths.iter().enumerate().step_by(stride) {
                let depth_m = f32::from(*depth) * 0.001;
                let point = rays.point(column, depth_m);
                let here = if is_in_band(depth_m, &point, gain, parameters) {
                    let step_m = DEPTH_STEP_M + 3.0 * libm::sqrtf(parameters.noise.variance_m2(depth_m));
                    let own = part(&point, [column, row], depth_m);
                    Above { part: self.join((column / stride, left), (depth_m, step_m), own), depth_m }
                } else {
                    Above::default()
                };
                // The row above is read up to the left of this pixel; what lies there is not needed any more.
                if let Some(slot) =
                    (column / stride).checked_sub(1).and_then(|before| self.above.get_mut(before))
                {
                    *slot = left;
                }
                left = here;
            }
            let last = depths.len().saturating_sub(1) / stride;
            if let Some(slot) = self.above.get_mut(last) {
                *slot = left;
            }
        }
    }

    /// Joins a pixel with its neighbours to the left and above, or begins a part.
    fn join(
        &mut self,
        (cell, left): (usize, Above),
        (depth_m, step_m): (f32, f32),
        own: BandPart,
    ) -> Option<u16> {
        let above = |cell: usize| self.above.get(cell).copied().unwrap_or_default();
        let before = cell.checked_sub(1).map(above).unwrap_or_default();
        let neighbours = [left, before, above(cell), above(cell.saturating_add(1))];
        let near = |neighbour: Above| neighbour.part.filter(|_| (neighbour.depth_m - depth_m).abs() < step_m);
        let part = self.parts.join(neighbours.into_iter().filter_map(near), &own);
        if part.is_err() {
            self.dropped = self.dropped.saturating_add(1);
        }
        part.ok()
    }

    /// The finished objects.
    pub(super) fn parts(&self) -> impl Iterator<Item = &BandPart> {
        self.parts.finished()
    }
}

fn is_in_band(depth_m: f32, point: &FloorPoint, gain: f32, parameters: &RgbdParameters) -> bool {
    let ([nearest, farthest], [lowest, highest]) = (parameters.legs.depth_m, parameters.legs.band_m);
    if !(depth_m >= nearest && depth_m < farthest && point.height_m > lowest && point.height_m < highest) {
        return false;
    }
    let height_variance = parameters.noise.variance_m2(depth_m) * gain * gain;
    point.height_m * point.height_m > SIGMAS * SIGMAS * height_variance
}

fn part(point: &FloorPoint, pixel: [usize; 2], depth_m: f32) -> BandPart {
    let place = [point.right_m, point.ahead_m, point.height_m];
    let pixel = pixel.map(|value| u16::try_from(value).unwrap_or(u16::MAX));
    BandPart {
        low_m: place,
        high_m: place,
        sums_m: [point.right_m, point.ahead_m, depth_m],
        pixels: 1,
        first_px: pixel,
        last_px: pixel,
    }
}
