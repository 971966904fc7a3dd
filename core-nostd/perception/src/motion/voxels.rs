//! Which voxels around the robot held something: a bit each, in a window that moves with the robot. Source: book,
//! Motion: Voxels.
//!
//! The lattice is fixed to the frame of the odometry and wraps around at the edge of the window, so nothing is moved
//! when the robot drives. Only points within [`Voxels::REACH_M`] of the robot may be entered or asked for: nothing else maps to
//! the same bit.

use floorguard_types::geometry::Point3;
use floorguard_types::number::{count_f32, exact_usize, nearest_f32, saturating_i32, truncating_u32};
use floorguard_types::profile::{Entry, Size, Table, TableOf};

/// Edge of a voxel, metres.
pub(super) const VOXEL_M: f32 = 0.1;
/// What is entered reaches this far, metres; less than a voxel, so that two voxels per axis cover it.
const MARGIN_M: f32 = 0.05;
/// Lowest voxel, metres above the floor at the robot.
const LOWEST_M: f32 = -0.5;
/// Levels: up to 2.7 m.
const LEVELS: i32 = 32;

/// A set of voxels, `S` columns along each side: per column of the ground a word, a bit per level.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Voxels<S: Size> {
    /// By y, then by x.
    columns: TableOf<TableOf<u32, S>, S>,
}

/// Column along x, along y, and level.
pub(super) type Cell = (i32, i32, i32);

/// Coordinates beyond ±2²⁴ voxels saturate: their neighbours are wrong, but nothing breaks.
pub(super) fn cell(point: Point3) -> Cell {
    let index = |metres: f32| floor(metres * (1.0 / VOXEL_M));
    (index(point.x_m), index(point.y_m), index(point.z_m - LOWEST_M).clamp(0, LEVELS - 1))
}

/// The next whole number below, without a call: this is asked some hundred thousand times a second.
#[inline]
pub(super) fn floor(value: f32) -> i32 {
    let whole = saturating_i32(value);
    whole.saturating_sub(i32::from(value < nearest_f32(whole)))
}

impl<S: Size> Voxels<S> {
    /// Farthest from the robot, along x and y each, metres: half the window, less what the robot may drive between two
    /// sweeps that are compared.
    pub(super) const REACH_M: f32 = count_f32(S::N) * VOXEL_M * 0.5 - 1.0;

    pub(super) const NEW: Self = Self { columns: Entry::BLANK };

    pub(super) fn clear(&mut self) {
        self.columns.iter_mut().for_each(|row| row.fill(0));
    }

    /// The lattice wraps around.
    fn wrap(index: i32) -> usize {
        const { assert!(S::N.is_power_of_two()) };
        exact_usize(truncating_u32(index)) & (S::N - 1)
    }

    /// Enters the voxels within [`MARGIN_M`] of a point, along the axes: noise at the border of a voxel is no change.
    pub(super) fn insert(&mut self, point: Point3) {
        let Point3 { x_m, y_m, z_m } = point;
        let (low_x, low_y, low_level) = cell(Point3::new(x_m - MARGIN_M, y_m - MARGIN_M, z_m - MARGIN_M));
        let (high_x, high_y, high_level) = cell(Point3::new(x_m + MARGIN_M, y_m + MARGIN_M, z_m + MARGIN_M));
        let bits =
            1_u32.wrapping_shl(truncating_u32(low_level)) | 1_u32.wrapping_shl(truncating_u32(high_level));
        for (x, y) in [(low_x, low_y), (high_x, low_y), (low_x, high_y), (high_x, high_y)] {
            let row = self.columns.get_mut(Self::wrap(y));
            if let Some(column) = row.and_then(|row| row.get_mut(Self::wrap(x))) {
                *column |= bits;
            }
        }
    }

    /// A voxel is entered.
    pub(super) fn holds(&self, (x, y, level): Cell) -> bool {
        let row = self.columns.get(Self::wrap(y));
        let column = row.and_then(|row| row.get(Self::wrap(x))).copied().unwrap_or(0);
        column & 1_u32.wrapping_shl(truncating_u32(level)) != 0
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::boxed::Box;

    type SmallVoxels = Voxels<floorguard_types::profile::Of<128>>;
    const REACH_M: f32 = SmallVoxels::REACH_M;

    #[test]
    fn holds_the_voxels_within_the_margin_only() {
        let mut voxels = Box::new(SmallVoxels::NEW);
        voxels.insert(Point3::new(-3.02, 2.02, 0.92));
        // Entered per axis: the voxel of the point, and the next one, whose border is 2 cm away.
        for (offset_m, held) in [(0.0, true), (0.03, true), (-0.07, true), (0.14, false), (-0.1, false)] {
            assert_eq!(voxels.holds(cell(Point3::new(-3.02 + offset_m, 2.02, 0.92))), held, "x {offset_m}");
        }
        for (offset_m, held) in [(0.03, true), (-0.07, true), (0.1, false), (-0.14, false)] {
            assert_eq!(voxels.holds(cell(Point3::new(-3.02, 2.02 + offset_m, 0.92))), held, "y {offset_m}");
            assert_eq!(voxels.holds(cell(Point3::new(-3.02, 2.02, 0.92 + offset_m))), held, "z {offset_m}");
        }
        voxels.clear();
        assert!(!voxels.holds(cell(Point3::new(-3.02, 2.02, 0.92))));
    }

    #[test]
    fn floors_as_the_library_does() {
        for value in [0.0_f32, -0.0, 0.99, -0.01, -1.0, 7.5, -7.5, 3.0e9, -3.0e9] {
            assert_eq!(floor(value), libm::floorf(value) as i32, "{value}");
        }
        assert_eq!(floor(f32::NAN), 0);
    }

    #[test]
    fn the_window_has_no_double_within_reach() {
        let mut voxels = Box::new(SmallVoxels::NEW);
        for robot_m in [0.0_f32, 7.3, -1_234.5] {
            voxels.clear();
            voxels.insert(Point3::new(robot_m + REACH_M, 0.0, 1.0));
            let other = Point3::new(robot_m - REACH_M, 0.0, 1.0);
            assert!(!voxels.holds(cell(other)), "at {robot_m}");
        }
    }

    #[test]
    fn numbers_that_are_none_do_no_harm() {
        let mut voxels = Box::new(SmallVoxels::NEW);
        for broken in [f32::NAN, f32::INFINITY, f32::NEG_INFINITY, f32::MAX] {
            voxels.insert(Point3::new(broken, broken, broken));
            let _ = voxels.holds(cell(Point3::new(broken, broken, broken)));
        }
    }
}
