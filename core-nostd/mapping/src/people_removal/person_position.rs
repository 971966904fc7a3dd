//! From a person's box in a picture to a place in space, by the lidar points that appear in it.

use floorguard_types::geometry::Point3;
use floorguard_types::number::{count_f32, nearest_f32, saturating_usize};
use floorguard_types::sensing::Pixel;
use floorguard_types::time::{Age, Stamp};

use super::camera::LensCamera;

/// A person in a picture, as a detector gives it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PersonBox {
    /// 0 to 1.
    pub confidence: f32,
    /// Left and upper edge, pixels.
    pub upper_left: Pixel,
    /// Right and lower edge, pixels.
    pub lower_right: Pixel,
}

/// How the place is found.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PositionMethod {
    /// The published one: the point that appears nearest to the middle of the box, wherever it lies in depth.
    NearestToMiddle,
    /// The nearest surface that fills a fifth of the middle third of the box: rays between the legs or beside the body do not
    /// decide.
    DepthMode,
}

/// Why a box gives no place.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum NoPosition {
    /// Confidence below 0.5.
    NotSure,
    /// Left is not left of right, above not above below, or a number is not finite.
    NoBox,
    /// No lidar point appears in it, or no depth has enough of them.
    NoPoints,
}

/// A detection below this is not used.
const CONFIDENCE_MIN: f32 = 0.5;
/// A sweep is used for a picture at most this much earlier or later, microseconds.
pub const SWEEP_AGE_MAX_US: u64 = 50_000;
/// Depth is counted in bins of 0.25 m ...
const BIN_M: f32 = 0.25;
/// ... up to 100 m.
const BINS: usize = 400;
/// A surface has at least so many points ...
const MODE_POINTS: u32 = 5;
/// ... and at least one in so many of all.
const MODE_SHARE: u32 = 5;
/// The range within the two bins of a surface is resolved so finely: 8 mm.
const FINE_BINS: usize = 64;

/// Whether a sweep belongs to a picture: at most 50 ms earlier or later.
///
/// ```
/// use floorguard_mapping::people_removal::is_of_image;
/// use floorguard_types::time::Stamp;
///
/// let image = Stamp::from_micros(1_000_000);
/// assert!(is_of_image(image, Stamp::from_micros(1_050_000)));
/// assert!(!is_of_image(image, Stamp::from_micros(949_999)));
/// ```
#[must_use]
pub const fn is_of_image(image: Stamp, sweep: Stamp) -> bool {
    match sweep.age(image) {
        Age::Past(micros) | Age::Future(micros) => micros <= SWEEP_AGE_MAX_US,
    }
}

/// Place of the person's surface in the lidar's frame. Cost: one projection a point, twice for [`PositionMethod::DepthMode`].
///
/// # Errors
/// See [`NoPosition`]; nothing is invented for such a box.
pub fn person_position(
    camera: &LensCamera,
    person: &PersonBox,
    points_in_lidar: impl Iterator<Item = Point3> + Clone,
    method: PositionMethod,
) -> Result<Point3, NoPosition> {
    let is_sure = person.confidence >= CONFIDENCE_MIN;
    if !is_sure {
        return Err(NoPosition::NotSure);
    }
    let is_box = person.upper_left.column < person.lower_right.column
        && person.upper_left.row < person.lower_right.row;
    if !is_box {
        return Err(NoPosition::NoBox);
    }
    let seen = points_in_lidar.filter_map(|point| Some((camera.project(point)?, point)));
    match method {
        PositionMethod::NearestToMiddle => nearest_to_middle(person, seen),
        PositionMethod::DepthMode => depth_mode(person, seen),
    }
}

impl PersonBox {
    fn middle(&self) -> Pixel {
        Pixel {
            column: 0.5 * (self.upper_left.column + self.lower_right.column),
            row: 0.5 * (self.upper_left.row + self.lower_right.row),
        }
    }

    /// Distance from the middle in parts of the width and height, the larger one: 0.5 on the edge of the box.
    fn share_from_middle(&self, pixel: Pixel) -> f32 {
        let middle = self.middle();
        let width = self.lower_right.column - self.upper_left.column;
        let height = self.lower_right.row - self.upper_left.row;
        let across = libm::fabsf(pixel.column - middle.column) / width.max(1.0e-3);
        across.max(libm::fabsf(pixel.row - middle.row) / height.max(1.0e-3))
    }
}

fn nearest_to_middle(
    person: &PersonBox,
    seen: impl Iterator<Item = (Pixel, Point3)>,
) -> Result<Point3, NoPosition> {
    let middle = person.middle();
    let mut best: Option<(f32, Point3)> = None;
    for (pixel, point) in seen.filter(|(pixel, _)| person.share_from_middle(*pixel) <= 0.5) {
        let (across, down) = (pixel.column - middle.column, pixel.row - middle.row);
        let squared = across * across + down * down;
        if best.is_none_or(|(least, _)| squared < least) {
            best = Some((squared, point));
        }
    }
    best.map(|(_, point)| point).ok_or(NoPosition::NoPoints)
}

fn range_m(point: Point3) -> f32 {
    libm::sqrtf(point.x_m * point.x_m + point.y_m * point.y_m + point.z_m * point.z_m)
}

fn depth_mode(
    person: &PersonBox,
    seen: impl Iterator<Item = (Pixel, Point3)> + Clone,
) -> Result<Point3, NoPosition> {
    let central =
        seen.filter(|(pixel, _)| person.share_from_middle(*pixel) <= 1.0 / 6.0).map(|(_, point)| point);
    let mut bins = [0_u32; BINS];
    let mut all = 0_u32;
    for point in central.clone() {
        if let Some(bin) = bins.get_mut(saturating_usize(range_m(point) / BIN_M)) {
            *bin = bin.saturating_add(1);
            all = all.saturating_add(1);
        }
    }
    let is_mode = |count: u32| count >= MODE_POINTS && count.saturating_mul(MODE_SHARE) >= all;
    // A surface may be cut by the limit of a bin: two neighbours count together.
    let mode = bins.windows(2).position(|pair| is_mode(pair.iter().sum()));
    let from_m = BIN_M * mode.map(nearest_f32).ok_or(NoPosition::NoPoints)?;
    on_surface(central, from_m).ok_or(NoPosition::NoPoints)
}

/// Mean direction of the points within 0.5 m behind `from_m`, at their median range.
fn on_surface(points: impl Iterator<Item = Point3>, from_m: f32) -> Option<Point3> {
    let width_m = 2.0 * BIN_M;
    let mut fine = [0_u32; FINE_BINS];
    let (mut sum, mut count) = ([0.0_f32; 3], 0_u32);
    for point in points {
        let range = range_m(point);
        let behind = range - from_m;
        if !(0.0..width_m).contains(&behind) {
            continue;
        }
        if let Some(bin) = fine.get_mut(saturating_usize(behind / width_m * count_f32(FINE_BINS))) {
            *bin = bin.saturating_add(1);
        }
        let one = 1.0 / range.max(1.0e-3);
        sum = [sum[0] + point.x_m * one, sum[1] + point.y_m * one, sum[2] + point.z_m * one];
        count = count.saturating_add(1);
    }
    let mut before = 0_u32;
    let half = count.div_ceil(2);
    let median = fine.iter().position(|bin| {
        before = before.saturating_add(*bin);
        before >= half && half > 0
    })?;
    let range = from_m + (nearest_f32(median) + 0.5) / count_f32(FINE_BINS) * width_m;
    let [x, y, z] = sum;
    let length = libm::sqrtf(x * x + y * y + z * z);
    let scale = range / length.max(1.0e-3);
    Some(Point3::new(x * scale, y * scale, z * scale))
}
