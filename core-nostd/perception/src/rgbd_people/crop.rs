//! A region cut out of the picture and brought to the size of the silhouette: its own depth, what lies behind it, and
//! what is unknown.
//!
//! Source: book, Depth people: Crops. The published code keeps a slab of depth; here a pixel belongs to the region when
//! its place on the floor does, so people before or behind are not cut into. A pixel without depth, or with something
//! nearer before it, is unknown: it may be body.

use super::floor_frame::FloorFrame;
use super::parameters::UpperBodyRules;
use super::regions::{Region, Regions};
use super::silhouette::SILHOUETTE_SIDE;
use floorguard_types::capacities::{RGBD_CROP_COLUMNS, RGBD_CROP_ROWS};
use floorguard_types::number::{nearest_f32, saturating_usize};
use floorguard_types::sensing::DepthImage;

/// What a pixel of a crop shows.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) enum CropPixel {
    /// Out of view: outside of the picture, or hidden by something nearer.
    #[default]
    Outside,
    /// Unknown: no return.
    Unknown,
    /// Something behind or beside the region.
    Behind,
    /// The region, at this depth in millimetres.
    Body(u16),
}

/// Whatever is nearer than the region by this much hides it, metres.
const HIDES_M: f32 = 0.3;

/// Where the top of the head is in a crop around one head.
pub(super) const HEAD_IN_CROP: (usize, usize) = (28, 12);

/// Where a crop lies in the picture.
#[derive(Clone, Copy, Debug)]
pub(super) struct CropPlace {
    /// Column and row of the crop's corner; may lie outside of the picture.
    pub corner_px: [f32; 2],
    /// Pixels of the picture for one of the crop.
    pub ratio: f32,
    /// Columns and rows in use.
    pub size: [usize; 2],
}

impl CropPlace {
    /// A crop of the upper part of a region, for a body of the given height in metres. `None` where nothing is left.
    pub(super) fn around(region: &Region, frame: &FloorFrame, body_m: f32) -> Option<Self> {
        let [_, fy] = frame.camera().focal_px();
        let ratio = fy * body_m / region.depth_m().max(0.1) / nearest_f32(3 * SILHOUETTE_SIDE);
        // Below a tenth of a pixel a crop would be larger than its picture.
        if !(0.1..100.0).contains(&ratio) {
            return None;
        }
        let margin = nearest_f32(SILHOUETTE_SIDE) * 0.5;
        let ([left, top], [right, bottom]) = (region.first_px, region.last_px);
        let columns = saturating_usize(nearest_f32(right.saturating_sub(left)) / ratio + 2.0 * margin);
        let rows = saturating_usize(nearest_f32(bottom.saturating_sub(top)) / ratio + 2.0 * margin);
        let size = [columns.min(RGBD_CROP_COLUMNS), rows.min(RGBD_CROP_ROWS)];
        let corner_px = [nearest_f32(left) - margin * ratio, nearest_f32(top) - 9.0 * ratio];
        Some(Self { corner_px, ratio, size })
    }

    /// A crop around one head: its top at a place of the picture, at a depth, for a body of the given height in metres.
    pub(super) fn at_head(
        [u, v]: [f32; 2],
        frame: &FloorFrame,
        (depth_m, body_m): (f32, f32),
    ) -> Option<Self> {
        let [_, fy] = frame.camera().focal_px();
        let ratio = fy * body_m / depth_m.max(0.1) / nearest_f32(3 * SILHOUETTE_SIDE);
        let (column, row) = HEAD_IN_CROP;
        (0.1..100.0).contains(&ratio).then_some(Self {
            corner_px: [u - nearest_f32(column) * ratio, v - nearest_f32(row) * ratio],
            ratio,
            size: [2 * column, row + SILHOUETTE_SIDE + 6],
        })
    }

    /// The place in the picture of a place in the crop.
    pub(super) fn pixel(&self, column: f32, row: f32) -> [f32; 2] {
        let [left, top] = self.corner_px;
        [left + column * self.ratio, top + row * self.ratio]
    }
}

/// Memory of one crop.
#[derive(Clone, Debug)]
pub(super) struct Crop {
    rows: [[CropPixel; RGBD_CROP_COLUMNS]; RGBD_CROP_ROWS],
}

impl Default for Crop {
    fn default() -> Self {
        Self { rows: [[CropPixel::Outside; RGBD_CROP_COLUMNS]; RGBD_CROP_ROWS] }
    }
}

impl Crop {
    /// Fills the crop from the picture, nearest pixel.
    pub(super) fn cut(
        &mut self,
        place: &CropPlace,
        (image, frame): (&DepthImage<'_>, &FloorFrame),
        (region, regions): (&Region, &Regions),
        rules: &UpperBodyRules,
    ) {
        let [columns, rows] = place.size;
        let width = image.width();
        let [_, highest] = rules.heights_m;
        let hidden_m = region.depth_m() - HIDES_M;
        for line in &mut self.rows {
            line.fill(CropPixel::Outside);
        }
        for (row, out) in self.rows.iter_mut().enumerate().take(rows) {
            let [_, v] = place.pixel(0.0, nearest_f32(row) + 0.5);
            if v < 0.0 || v >= nearest_f32(image.height()) {
                continue;
            }
            let source_row = saturating_usize(v);
            let rays = frame.row(source_row);
            let line = image.depth_mm().chunks_exact(width.max(1)).nth(source_row).unwrap_or(&[]);
            for (column, out) in out.iter_mut().enumerate().take(columns) {
                let [u, _] = place.pixel(nearest_f32(column) + 0.5, 0.0);
                if u < 0.0 {
                    continue;
                }
                let Some(depth_mm) = line.get(saturating_usize(u)).copied() else { continue };
                if depth_mm == 0 {
                    *out = CropPixel::Unknown;
                    continue;
                }
                let depth_m = f32::from(depth_mm) * 0.001;
                let point = rays.point(saturating_usize(u), depth_m);
                let is_body = point.height_m < highest && regions.label(&point) == region.label;
                *out = if is_body {
                    CropPixel::Body(depth_mm)
                } else if depth_m < hidden_m {
                    CropPixel::Outside
                } else {
                    CropPixel::Behind
                };
            }
        }
    }

    /// Mean depth of the region below the top of a head, metres; `None` where too little of it is there.
    pub(super) fn head_depth_m(&self, (column, row): (usize, usize)) -> Option<f32> {
        let (mut sum, mut count) = (0.0_f32, 0_u32);
        for line in self.window(column.saturating_sub(2), row.saturating_add(1)).take(6) {
            for pixel in line.iter().take(5) {
                if let CropPixel::Body(depth_mm) = pixel {
                    sum += f32::from(*depth_mm) * 0.001;
                    count = count.saturating_add(1);
                }
            }
        }
        (count >= 6).then(|| sum / nearest_f32(count))
    }

    /// A pixel; outside beyond the crop.
    #[inline]
    pub(super) fn get(&self, column: usize, row: usize) -> CropPixel {
        self.rows.get(row).and_then(|line| line.get(column)).copied().unwrap_or_default()
    }

    /// The rows from one on, each from a column on.
    pub(super) fn window(&self, column: usize, row: usize) -> impl Iterator<Item = &[CropPixel]> {
        self.rows.iter().skip(row).map(move |line| line.get(column..).unwrap_or(&[]))
    }
}
