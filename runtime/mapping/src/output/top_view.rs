//! Clouds seen from above: what stays in greys, what was removed in red.

use std::io::Cursor;

use floorguard_types::geometry::Point3;
use image::{ImageFormat, Rgb, RgbImage};

/// What is drawn.
#[derive(Clone, Copy, Debug)]
pub struct TopView<'a> {
    /// Points that stay, in the map.
    pub kept: &'a [Point3],
    /// Points that were removed, in the map; red above the others.
    pub removed: &'a [Point3],
    /// Only points within these heights of the map are drawn, metres.
    pub heights_m: [f32; 2],
}

/// Edge of a pixel, metres; doubled until the picture fits.
const PIXEL_M: f32 = 0.04;
/// Longest side, pixels.
const SIDE_MAX_PX: f32 = 2_400.0;
/// So many points make a pixel black.
const FULL: u32 = 12;
const PAPER: Rgb<u8> = Rgb([250, 250, 250]);
const REMOVED: Rgb<u8> = Rgb([214, 40, 40]);

/// Draws it; PNG. Both pictures of a pair show the same part of the map if `frame` is the same: all points that count for it.
#[must_use]
pub fn draw_top_view(view: &TopView<'_>, frame: &[Point3]) -> Vec<u8> {
    let drawn = |point: &&Point3| (view.heights_m[0]..=view.heights_m[1]).contains(&point.z_m);
    let mut corner = [f32::INFINITY; 2];
    let mut end = [f32::NEG_INFINITY; 2];
    for point in frame.iter().filter(drawn) {
        for (axis, value) in [point.x_m, point.y_m].into_iter().enumerate() {
            corner[axis] = corner[axis].min(value);
            end[axis] = end[axis].max(value);
        }
    }
    if corner[0] > end[0] {
        (corner, end) = ([0.0; 2], [1.0; 2]);
    }
    let extent_m = (end[0] - corner[0]).max(end[1] - corner[1]);
    let mut pixel_m = PIXEL_M;
    while extent_m / pixel_m > SIDE_MAX_PX {
        pixel_m *= 2.0;
    }
    let side = |axis: usize| ((end[axis] - corner[axis]) / pixel_m) as u32 + 1;
    let (width, height) = (side(0), side(1));
    let place = |point: &Point3| {
        let (x, y) = (((point.x_m - corner[0]) / pixel_m) as u32, ((point.y_m - corner[1]) / pixel_m) as u32);
        (x < width && y < height).then(|| (x, height - 1 - y))
    };
    let mut counts = vec![0_u32; (width * height) as usize];
    for (x, y) in view.kept.iter().filter(drawn).filter_map(place) {
        counts[(y * width + x) as usize] += 1;
    }
    let mut image =
        RgbImage::from_fn(width, height, |x, y| match counts[(y * width + x) as usize].min(FULL) {
            0 => PAPER,
            count => Rgb([(190 - 180 * count / FULL) as u8; 3]),
        });
    for (x, y) in view.removed.iter().filter(drawn).filter_map(place) {
        image.put_pixel(x, y, REMOVED);
    }
    let mut bytes = Cursor::new(Vec::new());
    // Into memory: a picture of at least one pixel can be written.
    let _ = image.write_to(&mut bytes, ImageFormat::Png);
    bytes.into_inner()
}
