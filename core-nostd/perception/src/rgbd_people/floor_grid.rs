//! What stands on the floor, seen from above: cells of 5 cm with the weight and the height of the returns in them.
//!
//! Source: book, Depth people: Floor grid. The published code bins the camera's own x and z; here they are places on
//! the floor, so that a tilted camera does not smear a body over several cells.

use super::floor_frame::{FloorFrame, FloorPoint};
use super::parameters::UpperBodyRules;
use floorguard_types::number::{nearest_f32, saturating_u8, saturating_usize};
use floorguard_types::sensing::DepthImage;

/// Cells across the view: −3 to 3 m.
pub(super) const GRID_COLUMNS: usize = 121;
/// Cells ahead: 0 to 7 m.
pub(super) const GRID_ROWS: usize = 141;
/// Cells.
pub(super) const GRID_CELLS: usize = GRID_COLUMNS * GRID_ROWS;
/// Cells a metre.
pub(super) const CELLS_PER_M: f32 = 20.0;
/// Half of the grid's width, metres.
const HALF_WIDTH_M: f32 = 3.0;
/// Pixels a row that are examined: neighbours in a larger image fall into the same cells.
const LATTICE_COLUMNS: usize = 320;
/// Focal length for which the published weights were made, pixels.
const PUBLISHED_FOCAL_PX: f32 = 525.0;
/// Half of the smoothing kernel, σ = 2 cells, 13 taps that sum to one (book, Depth people: Floor grid).
const KERNEL: [f32; 7] =
    [0.199_676_3, 0.176_213_12, 0.121_109_39, 0.064_825_185, 0.027_023_157, 0.008_773_134, 0.002_218_196];

/// The cell of a place; `None` outside the grid.
#[inline]
pub(super) fn cell_of(point: &FloorPoint) -> Option<usize> {
    let column = (point.right_m + HALF_WIDTH_M) * CELLS_PER_M + 0.5;
    let row = point.ahead_m * CELLS_PER_M + 0.5;
    let inside =
        column >= 0.0 && row >= 0.0 && column < nearest_f32(GRID_COLUMNS) && row < nearest_f32(GRID_ROWS);
    inside.then_some(saturating_usize(row) * GRID_COLUMNS + saturating_usize(column))
}

/// Every pixel that is examined: column, row, depth in metres and place.
pub(super) fn lattice<'a>(
    image: &DepthImage<'a>,
    frame: &FloorFrame,
    depth_m: [f32; 2],
) -> impl Iterator<Item = (usize, usize, f32, FloorPoint)> + use<'a> {
    let stride = (image.width() / LATTICE_COLUMNS).max(1);
    let frame = *frame;
    let [nearest, farthest] = depth_m;
    image.rows().enumerate().step_by(stride).flat_map(move |(row, depths)| {
        let rays = frame.row(row);
        depths.iter().enumerate().step_by(stride).filter_map(move |(column, depth)| {
            let z = f32::from(*depth) * 0.001;
            (z >= nearest && z < farthest).then(|| (column, row, z, rays.point(column, z)))
        })
    })
}

/// The grid of one picture.
#[derive(Clone, Debug)]
pub(super) struct FloorGrid {
    weights: [f32; GRID_CELLS],
    /// Height of the highest return in each cell, centimetres; 0 for none.
    tops_cm: [u8; GRID_CELLS],
}

impl Default for FloorGrid {
    fn default() -> Self {
        Self { weights: [0.0; GRID_CELLS], tops_cm: [0; GRID_CELLS] }
    }
}

impl FloorGrid {
    /// Projects a picture on the floor and smooths it. Returns how many pixels had a depth within the rules.
    pub(super) fn project(
        &mut self,
        image: &DepthImage<'_>,
        frame: &FloorFrame,
        rules: &UpperBodyRules,
    ) -> u32 {
        self.weights.fill(0.0);
        self.tops_cm.fill(0);
        let [fx, fy] = frame.camera().focal_px();
        let stride = nearest_f32((image.width() / LATTICE_COLUMNS).max(1));
        let density = PUBLISHED_FOCAL_PX * PUBLISHED_FOCAL_PX * stride * stride / (fx * fy);
        let [lowest, highest] = rules.heights_m;
        let mut returns = 0_u32;
        for (_, _, depth_m, point) in lattice(image, frame, rules.depth_m) {
            returns = returns.saturating_add(1);
            if !(point.height_m > lowest && point.height_m < highest) {
                continue;
            }
            let Some(cell) = cell_of(&point) else { continue };
            if let (Some(weight), Some(top)) = (self.weights.get_mut(cell), self.tops_cm.get_mut(cell)) {
                *weight += depth_m * (0.2 * depth_m).max(1.0) * density;
                *top = (*top).max(saturating_u8(point.height_m * 100.0));
            }
        }
        self.clear_structure(rules.structure_m);
        self.smooth();
        returns
    }

    /// Cells that reach higher than any person are none.
    fn clear_structure(&mut self, structure_m: f32) {
        let limit_cm = saturating_u8(structure_m * 100.0);
        for (weight, top) in self.weights.iter_mut().zip(&self.tops_cm) {
            if *top > limit_cm {
                *weight = 0.0;
            }
        }
    }

    /// Both axes, one after the other, in place; outside there is nothing.
    fn smooth(&mut self) {
        for row in self.weights.chunks_exact_mut(GRID_COLUMNS) {
            let mut line = [0.0_f32; GRID_COLUMNS];
            line.iter_mut().zip(row.iter()).for_each(|(copy, weight)| *copy = *weight);
            convolve(&line, row.iter_mut());
        }
        for column in 0..GRID_COLUMNS {
            let mut line = [0.0_f32; GRID_ROWS];
            for (copy, weight) in line.iter_mut().zip(self.weights.iter().skip(column).step_by(GRID_COLUMNS))
            {
                *copy = *weight;
            }
            convolve(&line, self.weights.iter_mut().skip(column).step_by(GRID_COLUMNS));
        }
    }

    /// Smoothed weights, row by row from the nearest.
    pub(super) fn weights(&self) -> &[f32] {
        &self.weights
    }

    /// Height of the highest return within `radius_m` of a place, metres; 0 where nothing is.
    pub(super) fn top_near_m(&self, place: &FloorPoint, radius_m: f32) -> f32 {
        let mut top = 0_u8;
        for step_right in -8_i8..=8 {
            for step_ahead in -8_i8..=8 {
                let (right, ahead) =
                    (f32::from(step_right) / CELLS_PER_M, f32::from(step_ahead) / CELLS_PER_M);
                if right * right + ahead * ahead > radius_m * radius_m {
                    continue;
                }
                let beside = FloorPoint {
                    right_m: place.right_m + right,
                    ahead_m: place.ahead_m + ahead,
                    height_m: 0.0,
                };
                let height = cell_of(&beside).and_then(|cell| self.tops_cm.get(cell));
                top = top.max(height.copied().unwrap_or(0));
            }
        }
        f32::from(top) * 0.01
    }
}

fn convolve<'a, const LENGTH: usize>(line: &[f32; LENGTH], out: impl Iterator<Item = &'a mut f32>) {
    for (middle, out) in out.enumerate() {
        let mut sum = 0.0;
        for (offset, tap) in KERNEL.iter().enumerate() {
            let after = line.get(middle.saturating_add(offset)).copied().unwrap_or(0.0);
            let before = middle.checked_sub(offset).and_then(|index| line.get(index)).copied().unwrap_or(0.0);
            sum += if offset == 0 { tap * after } else { tap * (before + after) };
        }
        *out = sum;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn kernel_is_normal_and_sums_to_one() {
        let sum: f32 = KERNEL[0] + 2.0 * KERNEL[1..].iter().sum::<f32>();
        assert!((sum - 1.0).abs() < 1e-4, "{sum}");
        for (offset, tap) in KERNEL.iter().enumerate() {
            let normal = KERNEL[0] * libm::expf(-((offset * offset) as f32) / 8.0);
            assert!((tap - normal).abs() < 1e-4);
        }
    }

    #[test]
    fn smoothing_keeps_the_weight_of_an_inner_cell() {
        let mut grid = std::boxed::Box::<FloorGrid>::default();
        grid.weights[60 * GRID_COLUMNS + 60] = 1_000.0;
        grid.smooth();
        let sum: f32 = grid.weights.iter().sum();
        assert!((sum - 1_000.0).abs() < 1.0, "{sum}");
        assert!((grid.weights[60 * GRID_COLUMNS + 61] - grid.weights[61 * GRID_COLUMNS + 60]).abs() < 1e-3);
    }

    #[test]
    fn places_beyond_the_grid_have_no_cell() {
        let at = |right_m, ahead_m| cell_of(&FloorPoint { right_m, ahead_m, height_m: 1.0 });
        assert_eq!(at(-3.0, 0.0), Some(0));
        assert_eq!(at(3.0, 7.0), Some(GRID_CELLS - 1));
        for (right, ahead) in [(3.1, 1.0), (-3.1, 1.0), (0.0, 7.1), (0.0, -0.1), (f32::NAN, 1.0)] {
            assert_eq!(at(right, ahead), None);
        }
    }
}
