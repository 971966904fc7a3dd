//! Scores of earlier frames for the same places of the floor.
//!
//! Dirt stays where it is while the robot drives; reflections of lamps and shadows of people move over it, and noise is
//! new in every frame. So the scores of earlier frames are carried along with the floor and averaged, older ones with
//! less weight. From one viewpoint no second frame is remembered, however long the robot stands.

use super::pixels::HALF_COLUMNS_MAX;
use crate::floor::root::{greater, nearest};
use crate::floor::{Plane, dot};
use floorguard_types::geometry::{Point2, Pose2};
use floorguard_types::number::nearest_f32;
use floorguard_types::sensing::PinholeCamera;

/// From where a frame was taken.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FloorView {
    /// The camera at the image's full size.
    pub camera: PinholeCamera,
    /// The floor in the camera's frame.
    pub plane: Plane,
    /// The robot by odometry or in the map, the same frame for all views.
    pub robot_in_map: Pose2,
    /// The camera's foot point and the direction it looks along, seen from the robot.
    pub camera_in_robot: Pose2,
}

/// What an earlier frame counts against the next newer one.
const FADE: f32 = 0.8;
/// A viewpoint is another after this distance or turn (half the cell of the dirt map).
const MOVED_M: f32 = 0.05;
const TURNED_RAD: f32 = 0.05;

/// Remembered sum of scores and of weights of a pixel.
pub type Remembered = [f32; 2];

impl FloorView {
    /// The camera's foot point and direction in the map.
    #[must_use]
    pub fn foot_in_map(&self) -> Pose2 {
        self.robot_in_map.compose(self.camera_in_robot)
    }

    /// Where a pixel of the full image meets the floor, in the map; `None` above the horizon.
    #[must_use]
    pub fn place_in_map(&self, column: f32, row: f32) -> Option<Point2> {
        let ray = self.camera.ray(column, row);
        let [right, along] = self.plane.axes();
        let down = -dot(self.plane.normal, ray);
        (down > 1.0e-3).then(|| {
            let scale = self.plane.distance_m / down;
            self.foot_in_map().transform(Point2::new(scale * dot(along, ray), -scale * dot(right, ray)))
        })
    }

    /// True if another view is from somewhere else.
    pub(super) fn is_elsewhere(&self, other: &Self) -> bool {
        let moved = other.foot_in_map().inverse().compose(self.foot_in_map());
        libm::hypotf(moved.x_m, moved.y_m) >= MOVED_M || moved.heading_rad.abs() >= TURNED_RAD
    }

    /// Maps a pixel of this view's half-size image to the same place of the floor in another's.
    fn homography_to(&self, other: &Self) -> Homography {
        let moved = other.foot_in_map().inverse().compose(self.foot_in_map());
        let (sin, cos) = libm::sincosf(moved.heading_rad);
        let column = |pixel: [f32; 3]| {
            let [forward, left, scale] = self.floor_of(pixel);
            other.pixel_of([
                moved.x_m * scale + cos * forward - sin * left,
                moved.y_m * scale + sin * forward + cos * left,
                scale,
            ])
        };
        let columns = [column([1.0, 0.0, 0.0]), column([0.0, 1.0, 0.0]), column([0.0, 0.0, 1.0])];
        Homography { columns }
    }

    /// Homogeneous place on the floor, forward and left of the foot point, of a homogeneous half-size pixel.
    fn floor_of(&self, [column, row, one]: [f32; 3]) -> [f32; 3] {
        let camera = self.camera.shrunk(2);
        let ([fx, fy], [cx, cy]) = (camera.focal_px(), camera.centre_px());
        let ray = [(column - cx * one) / fx, (row - cy * one) / fy, one];
        let [right, along] = self.plane.axes();
        let height = self.plane.distance_m;
        [height * dot(along, ray), -height * dot(right, ray), -dot(self.plane.normal, ray)]
    }

    /// Homogeneous half-size pixel of a homogeneous place on the floor.
    fn pixel_of(&self, [forward, left, one]: [f32; 3]) -> [f32; 3] {
        let camera = self.camera.shrunk(2);
        let ([fx, fy], [cx, cy]) = (camera.focal_px(), camera.centre_px());
        let [[rx, ry, rz], [ax, ay, az]] = self.plane.axes();
        let [nx, ny, nz] = self.plane.normal.map(|value| value * self.plane.distance_m * one);
        let x = forward * ax - left * rx - nx;
        let y = forward * ay - left * ry - ny;
        let z = forward * az - left * rz - nz;
        [fx * x + cx * z, fy * y + cy * z, z]
    }
}

/// A linear map of homogeneous pixels, by its columns.
struct Homography {
    columns: [[f32; 3]; 3],
}

impl Homography {
    #[inline]
    fn map(&self, column: f32, row: f32) -> Option<(f32, f32)> {
        let [[a, d, g], [b, e, h], [c, f, i]] = self.columns;
        let scale = g * column + h * row + i;
        let inverse = 1.0 / scale;
        let place = ((a * column + b * row + c) * inverse, (d * column + e * row + f) * inverse);
        (scale > 1.0e-6).then_some(place)
    }
}

/// Averages scores with what is remembered from another view of the floor, and writes what to remember into `next`.
pub(super) fn recall(
    (view, before): (&FloorView, &FloorView),
    columns: usize,
    scores: &mut [f32],
    (past, next): (&[Remembered], &mut [Remembered]),
) {
    let columns = columns.clamp(1, HALF_COLUMNS_MAX);
    let homography = view.homography_to(before);
    let rows = scores.chunks_exact_mut(columns).zip(next.chunks_exact_mut(columns));
    for (row, (scores, next)) in rows.enumerate() {
        for (column, (score, next)) in scores.iter_mut().zip(next).enumerate() {
            let place = homography.map(nearest_f32(column), nearest_f32(row));
            let [sum, weight] = place.map_or([0.0; 2], |place| sample(past, columns, place));
            let (mut sum, mut weight) = (FADE * sum, FADE * weight);
            if !score.is_nan() {
                sum += *score;
                weight += 1.0;
                *score = sum / weight;
            }
            *next = [sum, weight];
        }
    }
}

/// What to remember of a first frame.
pub(super) fn remember(scores: &[f32], next: &mut [Remembered]) {
    for (score, next) in scores.iter().zip(next) {
        *next = if score.is_nan() { [0.0; 2] } else { [*score, 1.0] };
    }
}

/// Between four pixels; nothing outside of the image.
#[inline]
fn sample(past: &[Remembered], columns: usize, (column, row): (f32, f32)) -> Remembered {
    if !(column >= 0.0 && row >= 0.0 && column < nearest_f32(columns.saturating_sub(1))) {
        return [0.0; 2];
    }
    // The nearest of half a pixel before is the pixel before; on a pixel, both it and the one before it mix to the same.
    let (whole_column, whole_row) = (nearest(greater(column - 0.5, 0.0)), nearest(greater(row - 0.5, 0.0)));
    let (left, top) = (nearest_f32(whole_column), nearest_f32(whole_row));
    let start = whole_row.wrapping_mul(columns).wrapping_add(whole_column);
    let pair = |start: usize| past.get(start..start.wrapping_add(2));
    let (Some([a, b]), Some([c, d])) = (pair(start), pair(start.wrapping_add(columns))) else {
        return [0.0; 2];
    };
    let (x, y) = (column - left, row - top);
    let mix = |a: f32, b: f32, c: f32, d: f32| (1.0 - y) * (a + x * (b - a)) + y * (c + x * (d - c));
    let ([a0, a1], [b0, b1], [c0, c1], [d0, d1]) = (a, b, c, d);
    [mix(*a0, *b0, *c0, *d0), mix(*a1, *b1, *c1, *d1)]
}

#[cfg(test)]
mod tests {
    use super::*;

    fn view(x_m: f32, heading_rad: f32) -> FloorView {
        FloorView {
            camera: PinholeCamera::new([525.0, 520.0], [319.5, 239.5]).unwrap(),
            plane: Plane::of_mounting(0.72, 0.8).unwrap(),
            robot_in_map: Pose2::new(x_m, 0.4, heading_rad),
            camera_in_robot: Pose2::new(0.3, 0.1, 0.0),
        }
    }

    /// A pixel and where the homography takes it are the same place of the map.
    #[test]
    fn homography_keeps_the_place() {
        let (now, before) = (view(2.0, 0.3), view(1.9, 0.25));
        let homography = now.homography_to(&before);
        for (column, row) in [(10.0, 10.0), (160.0, 200.0), (300.0, 120.0)] {
            let (u, v) = homography.map(column, row).unwrap();
            let here = now.place_in_map(2.0 * column + 0.5, 2.0 * row + 0.5).unwrap();
            let there = before.place_in_map(2.0 * u + 0.5, 2.0 * v + 0.5).unwrap();
            assert!(here.distance(there) < 1e-4, "{here:?} {there:?}");
        }
    }

    #[test]
    fn only_another_viewpoint_counts() {
        assert!(!view(2.0, 0.3).is_elsewhere(&view(2.01, 0.3)));
        assert!(view(2.0, 0.3).is_elsewhere(&view(2.1, 0.3)));
        assert!(view(2.0, 0.3).is_elsewhere(&view(2.0, 0.4)));
    }

    /// From the same view the mean is over both frames; what is no floor now is not judged but not forgotten.
    #[test]
    fn averages_where_both_saw_floor() {
        let (columns, pixels) = (8_usize, 48_usize);
        let view = view(0.0, 0.0);
        let past = std::vec![[10.0, 1.0]; pixels];
        let mut next = std::vec![[0.0; 2]; pixels];
        let mut scores = std::vec![19.0_f32; pixels];
        scores[9] = f32::NAN;
        recall((&view, &view), columns, &mut scores, (&past, &mut next));
        assert!((scores[10] - (19.0 + 0.8 * 10.0) / 1.8).abs() < 1e-3, "{}", scores[10]);
        assert!(scores[9].is_nan() && (next[9][0] - 8.0).abs() < 0.1);
    }
}
