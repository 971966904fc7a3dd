//! The swath as bits: which 64ths of which cells the brush has just swept.
//!
//! A cell has 8 × 8 sub-samples. Remembering them for the present pass makes "newly covered ground" exact when the
//! brush sweeps the same ground twice, as it does when turning, and makes the belief independent of the step size
//! (book, Cleaning: Swath; error of the share at most 1/64 as a rule).

use super::swath::Swath;
use floorguard_mapping::{GridCoordinates, GridGeometry};
use floorguard_types::geometry::Point2;
use floorguard_types::number::{
    nearest_f32, saturating_i32, truncating_i32, truncating_u32, truncating_usize,
};

/// Sub-samples along the edge of a cell.
const SAMPLES: i32 = 8;

/// Sub-samples along the edge of the window that one step can touch, eight cells: brush and step of up to 0.7 m at 0.1 m. A
/// line of the window is one word.
const LINES: usize = 64;
/// Cells of a line.
const LINE_CELLS: u32 = 8;
/// The last of them.
const LAST: i32 = 63;

/// Swept sub-samples of the cells around one step of one particle.
#[derive(Clone, Copy, Debug)]
pub struct SwathMask {
    first_column: i32,
    first_row: i32,
    /// A bit for every sub-sample of a line.
    lines: [u64; LINES],
    /// Rows of cells that were touched, counted from the window's corner.
    rows: usize,
    clipped: bool,
}

/// A cell of the raster, and which part of it the brush has swept.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct SweptCell {
    /// Along x; may lie outside of the raster.
    pub column: i32,
    /// Along y; may lie outside of the raster.
    pub row: i32,
    /// A bit for each of 8 × 8 samples, rows of eight from the lower left.
    pub samples: u64,
}

impl SwathMask {
    /// Rasterises a swath. Ground beyond the window is not marked, so nothing is claimed for it; [`Self::is_clipped`]
    /// then says so.
    #[inline]
    #[must_use]
    pub fn of(swath: &Swath, geometry: &GridGeometry) -> Self {
        let (mut low_x, mut low_y) = (f32::MAX, f32::MAX);
        for corner in swath.pieces().flatten() {
            low_x = low_x.min(corner.x_m);
            low_y = low_y.min(corner.y_m);
        }
        let GridCoordinates { column: first_column, row: first_row } =
            geometry.coordinates_of(Point2::new(low_x, low_y));
        let mut mask = Self { first_column, first_row, lines: [0; LINES], rows: 0, clipped: false };
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

    /// Every cell that was touched.
    #[inline]
    pub fn cells(&self) -> impl Iterator<Item = SweptCell> + '_ {
        let rows = self.lines.chunks_exact(truncating_usize(SAMPLES)).take(self.rows).zip(0_i32..);
        rows.flat_map(move |(lines, row)| {
            let touched = lines.iter().fold(0, |all, line| all | line);
            let width = u64::BITS.saturating_sub(touched.leading_zeros()).div_ceil(truncating_u32(SAMPLES));
            (0..width.min(LINE_CELLS)).filter_map(move |column| {
                let shift = column.saturating_mul(truncating_u32(SAMPLES));
                let mut mask = 0_u64;
                for (line, place) in lines.iter().zip((0..64).step_by(truncating_usize(SAMPLES))) {
                    mask |= ((line >> shift) & 0xff) << place;
                }
                let (column, row) = (
                    self.first_column.saturating_add(truncating_i32(column)),
                    self.first_row.saturating_add(row),
                );
                (mask != 0).then_some(SweptCell { column, row, samples: mask })
            })
        })
    }

    /// Marks the sub-samples whose centres lie within a convex piece, line by line.
    #[inline]
    fn fill(&mut self, corners: &[Point2], geometry: &GridGeometry) {
        let scale = geometry.cells_per_metre() * nearest_f32(SAMPLES);
        let origin = geometry.origin_in_map();
        // In sub-samples from the window's corner; the centre of sample (i, j) is (i + ½, j + ½).
        let base_x = nearest_f32(self.first_column) * nearest_f32(SAMPLES) + 0.5;
        let base_y = nearest_f32(self.first_row) * nearest_f32(SAMPLES) + 0.5;
        let mut points = [Point2::default(); 4];
        let (mut low, mut high) = (f32::MAX, f32::MIN);
        for (point, corner) in points.iter_mut().zip(corners) {
            point.x_m = (corner.x_m - origin.x_m) * scale - base_x;
            point.y_m = (corner.y_m - origin.y_m) * scale - base_y;
            low = low.min(point.y_m);
            high = high.max(point.y_m);
        }
        let limit = nearest_f32(LINES);
        self.clipped |= high >= limit;
        let points = points.get(..corners.len().min(4)).unwrap_or(&[]);
        let edges = Edges::of(points);
        let first = ceiling(low).clamp(0, truncating_i32(LINES));
        let count = floor(high).min(LAST).saturating_sub(first).saturating_add(1).max(0);
        let end = first.saturating_add(count);
        self.rows = self.rows.max(truncating_usize(end).div_ceil(truncating_usize(SAMPLES)));
        let lines =
            self.lines.iter_mut().zip(0_i32..).take(truncating_usize(end)).skip(truncating_usize(first));
        for (bits, line) in lines {
            let Some((from, to)) = edges.crossings(nearest_f32(line)) else { continue };
            self.clipped |= to >= limit;
            let (from, to) = (ceiling(from).max(0), floor(to).min(LAST));
            if from <= to {
                // from..=to within 0..64: a run of at most 64 bits.
                *bits |= (u64::MAX >> LAST.saturating_sub(to.saturating_sub(from))) << from;
            }
        }
    }
}

/// The edges of a convex outline, with their slopes: one division an edge and none a line.
struct Edges {
    /// Lower and upper end in lines, place of the lower end on its line, and slope.
    edges: [(f32, f32, f32, f32); 4],
}

impl Edges {
    #[inline]
    fn of(points: &[Point2]) -> Self {
        // An edge that no line crosses.
        let mut edges = [(f32::MAX, f32::MIN, 0.0, 0.0); 4];
        let Some(&last) = points.last() else { return Self { edges } };
        let mut previous = last;
        for (edge, &point) in edges.iter_mut().zip(points) {
            let (low, high) = if point.y_m < previous.y_m { (point, previous) } else { (previous, point) };
            let rise = high.y_m - low.y_m;
            if rise > 0.0 {
                let slope = (high.x_m - low.x_m) / rise;
                *edge = (low.y_m, high.y_m, low.x_m, slope);
            }
            previous = point;
        }
        Self { edges }
    }

    /// Where a horizontal line enters and leaves the outline.
    #[inline]
    fn crossings(&self, line: f32) -> Option<(f32, f32)> {
        let (mut from, mut to) = (f32::MAX, f32::MIN);
        for &(low, high, x, slope) in &self.edges {
            // The lower end belongs to the edge, the upper one to the next.
            if low <= line && line < high {
                let at = x + (line - low) * slope;
                from = from.min(at);
                to = to.max(at);
            }
        }
        (from <= to).then_some((from, to))
    }
}

/// Floor for |value| < 2¹⁵ without a library call; larger values saturate into the clipping of the caller.
#[inline]
fn floor(value: f32) -> i32 {
    saturating_i32(value + 32_768.0).saturating_sub(32_768)
}

#[inline]
fn ceiling(value: f32) -> i32 {
    floor(-value).saturating_neg()
}

#[cfg(test)]
mod tests {
    use super::super::swath::Brush;
    use super::*;
    use floorguard_types::geometry::Pose2;
    use floorguard_types::random::Pcg32;

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
            for SweptCell { column, row, samples: bits } in mask.cells() {
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
            for SweptCell { column, row, samples: bits } in mask.cells() {
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
            assert!(mask.cells().count() <= 64);
        }
    }
}
