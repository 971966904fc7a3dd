//! The swath as bits: which 64ths of which cells the brush has just swept.
//!
//! A cell has 8 × 8 sub-samples. Remembering them for the present pass makes "newly covered ground" exact when the
//! brush sweeps the same ground twice, as it does when turning, and makes the belief independent of the step size
//! (algorithms I.3, `PassCoverage`; error of the share at most 1/64 as a rule).

use super::swath::Swath;
use crate::geometry::Point2;
use crate::maps::GridGeometry;

/// Sub-samples along the edge of a cell.
const SAMPLES: i32 = 8;
/// Cells along the edge of the window that one step can touch: brush and step of up to 0.7 m at 0.1 m.
pub const WINDOW: usize = 8;

/// Swept sub-samples of the cells around one step of one particle.
#[derive(Clone, Copy, Debug)]
pub struct SwathMask {
    first_column: i32,
    first_row: i32,
    masks: [[u64; WINDOW]; WINDOW],
    clipped: bool,
}

impl SwathMask {
    /// Rasterises a swath. Ground beyond the window is not marked, so nothing is claimed for it; [`Self::is_clipped`]
    /// then says so.
    #[must_use]
    pub fn of(swath: &Swath, geometry: &GridGeometry) -> Self {
        let (mut low_x, mut low_y) = (f32::MAX, f32::MAX);
        for corner in swath.pieces().flatten() {
            low_x = low_x.min(corner.x_m);
            low_y = low_y.min(corner.y_m);
        }
        let (first_column, first_row) = geometry.coordinates_of(Point2::new(low_x, low_y));
        let mut mask = Self { first_column, first_row, masks: [[0; WINDOW]; WINDOW], clipped: false };
        for corners in swath.pieces() {
            mask.fill(corners, geometry);
        }
        mask
    }

    /// Part of the swath lay beyond the window.
    #[must_use]
    pub const fn is_clipped(&self) -> bool {
        self.clipped
    }

    /// Column, row and swept sub-samples of every cell that was touched.
    pub fn cells(&self) -> impl Iterator<Item = (i32, i32, u64)> + '_ {
        self.masks.iter().zip(0_i32..).flat_map(move |(line, row)| {
            line.iter().zip(0_i32..).filter(|(mask, _)| **mask != 0).map(move |(&mask, column)| {
                (self.first_column.saturating_add(column), self.first_row.saturating_add(row), mask)
            })
        })
    }

    /// Marks the sub-samples whose centres lie within a convex piece, line by line.
    #[inline]
    fn fill(&mut self, corners: &[Point2], geometry: &GridGeometry) {
        let scale = geometry.cells_per_metre() * SAMPLES as f32;
        let origin = geometry.origin_in_map();
        // In sub-samples from the window's corner; the centre of sample (i, j) is (i + ½, j + ½).
        let base_x = self.first_column as f32 * SAMPLES as f32 + 0.5;
        let base_y = self.first_row as f32 * SAMPLES as f32 + 0.5;
        let mut points = [Point2::default(); 4];
        let (mut low, mut high) = (f32::MAX, f32::MIN);
        for (point, corner) in points.iter_mut().zip(corners) {
            point.x_m = (corner.x_m - origin.x_m) * scale - base_x;
            point.y_m = (corner.y_m - origin.y_m) * scale - base_y;
            low = low.min(point.y_m);
            high = high.max(point.y_m);
        }
        let limit = (WINDOW as i32).saturating_mul(SAMPLES);
        self.clipped |= high >= limit as f32;
        let points = points.get(..corners.len().min(4)).unwrap_or(&[]);
        let first = (ceiling(low)).max(0);
        let last = (floor(high)).min(limit.saturating_sub(1));
        for line in first..=last {
            if let Some((from, to)) = crossings(points, line as f32) {
                self.clipped |= to >= limit as f32;
                self.mark(line, ceiling(from).max(0), floor(to).min(limit.saturating_sub(1)));
            }
        }
    }

    fn mark(&mut self, line: i32, from: i32, to: i32) {
        let shift = line.rem_euclid(SAMPLES).saturating_mul(SAMPLES) as u32;
        let Some(row) = self.masks.get_mut((line / SAMPLES) as usize) else { return };
        for (mask, column) in row.iter_mut().zip(0_i32..) {
            let start = from.saturating_sub(column.saturating_mul(SAMPLES)).max(0);
            let end = to.saturating_sub(column.saturating_mul(SAMPLES)).min(SAMPLES.saturating_sub(1));
            if start <= end {
                // start..=end within 0..8: a run of at most eight bits.
                let run = (0xff_u64 >> 7_i32.saturating_sub(end.saturating_sub(start))) << start;
                *mask |= run << shift;
            }
        }
    }
}

/// Floor for |value| < 2¹⁵ without a library call; larger values saturate into the clipping of the caller.
#[inline]
fn floor(value: f32) -> i32 {
    ((value + 32_768.0) as i32).saturating_sub(32_768)
}

#[inline]
fn ceiling(value: f32) -> i32 {
    floor(-value).saturating_neg()
}

/// Where a horizontal line enters and leaves a convex outline.
#[inline]
fn crossings(points: &[Point2], line: f32) -> Option<(f32, f32)> {
    let (mut from, mut to) = (f32::MAX, f32::MIN);
    let mut previous = points.last().copied()?;
    for &point in points {
        if (point.y_m > line) != (previous.y_m > line) {
            // The two differ, so the divisor is not zero.
            let t = (line - point.y_m) / (previous.y_m - point.y_m);
            let x = point.x_m + t * (previous.x_m - point.x_m);
            from = from.min(x);
            to = to.max(x);
        }
        previous = point;
    }
    (from <= to).then_some((from, to))
}

#[cfg(test)]
mod tests {
    use super::super::swath::Brush;
    use super::*;
    use crate::geometry::Pose2;
    use crate::random::Pcg32;

    /// Against the exact clip: over many random steps the shares agree on average, and each within a few 64ths.
    #[test]
    fn agrees_with_the_exact_area() {
        let geometry = GridGeometry::new(40, 40, 0.1, Point2::new(-1.0, -1.0)).unwrap();
        let brush = Brush { width_m: 0.17, offset_m: 0.03 };
        let mut generator = Pcg32::new(5, 5);
        let (mut difference, mut cells) = (0.0_f64, 0_u32);
        for _ in 0..2_000 {
            let pose = Pose2::new(
                generator.uniform_between(0.0, 2.0),
                generator.uniform_between(0.0, 2.0),
                generator.uniform_between(-3.0, 3.0),
            );
            let forward = generator.uniform_between(-0.1, 0.15);
            let next = pose.compose(Pose2::new(forward, 0.0, generator.uniform_between(-0.2, 0.2)));
            let swath = Swath::between(brush.bar_at(pose), brush.bar_at(next));
            let mask = SwathMask::of(&swath, &geometry);
            assert!(!mask.is_clipped());
            for (column, row, bits) in mask.cells() {
                let corner = Point2::new(-1.0 + column as f32 * 0.1, -1.0 + row as f32 * 0.1);
                let error = bits.count_ones() as f32 / 64.0 - swath.share_of_square(corner, 0.1);
                assert!(error.abs() < 0.13, "{error}");
                difference += f64::from(error);
                cells += 1;
            }
        }
        assert!(cells > 5_000 && (difference / f64::from(cells)).abs() < 0.004, "{difference} {cells}");
    }

    #[test]
    fn a_full_lane_covers_every_sample_once() {
        let geometry = GridGeometry::new(40, 40, 0.1, Point2::default()).unwrap();
        let brush = Brush { width_m: 0.17, offset_m: 0.0 };
        let mut covered = 0_u64;
        for step in 0..10 {
            let at = |s: i32| brush.bar_at(Pose2::new(0.9 + s as f32 * 0.037, 1.05, 0.0));
            let mask = SwathMask::of(&Swath::between(at(step), at(step + 1)), &geometry);
            for (column, row, bits) in mask.cells() {
                if (column, row) == (10, 10) {
                    assert_eq!(covered & bits, 0, "the same ground twice on a straight lane");
                    covered |= bits;
                }
            }
        }
        assert_eq!(covered, u64::MAX);
    }

    #[test]
    fn hostile_poses_mark_nothing_outside() {
        let geometry = GridGeometry::new(40, 40, 0.1, Point2::default()).unwrap();
        for bad in [f32::NAN, f32::INFINITY, 1e30] {
            let bar = [Point2::new(bad, 0.0), Point2::new(0.0, bad)];
            let mask = SwathMask::of(&Swath::between(bar, [Point2::default(); 2]), &geometry);
            assert!(mask.cells().count() <= WINDOW * WINDOW);
        }
    }
}
