//! One level of a field, as the matcher reads it.

use floorguard_types::geometry::Point2;
use floorguard_types::number::{nearest_f32, saturating_i32};

use super::part::FieldPart;
use crate::grid::GridGeometry;

/// One level of a field. A value of 255 means a return at the centre of the cell, 0 none within the reach; between them
/// the value falls linearly with the distance. At level `shift` a cell holds the largest value of the 2^`shift` ×
/// 2^`shift` cells that begin at it and run towards larger coordinates (Hess et al. 2016, section V.B): an upper bound
/// of all of them.
#[derive(Clone, Copy, Debug)]
pub struct FieldLevel<'a> {
    /// Where the cells lie; the same for all levels of a field.
    pub geometry: GridGeometry,
    /// Which of them are stored; the others are 0.
    pub part: FieldPart,
    /// The values of the part, by index.
    pub values: &'a [u8],
    /// Binary logarithm of the cells along the side of the bounded square.
    pub shift: u8,
}

/// Value and slope of a field between its cells.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct FieldSample {
    /// 0 to 1.
    pub value: f32,
    /// Change a metre along x.
    pub slope_x: f32,
    /// Change a metre along y.
    pub slope_y: f32,
}

impl FieldLevel<'_> {
    /// The value of a cell, 0 outside. Coordinates just below zero are answered by the first cell, which bounds them.
    #[inline]
    #[must_use]
    pub fn at(&self, column: i32, row: i32) -> u8 {
        let below = -(1_i32 << self.shift.min(15));
        if column <= below || row <= below {
            return 0;
        }
        let index = self.part.index(column.max(0), row.max(0));
        index.and_then(|index| self.values.get(index)).copied().unwrap_or(0)
    }

    /// Value and slope at a point of the field's frame, bilinear between the centres of four cells; level 0 only.
    #[inline]
    #[must_use]
    pub fn sample(&self, point: Point2) -> FieldSample {
        let scale = self.geometry.cells_per_metre();
        let origin = self.geometry.origin_in_map();
        let (x, y) = ((point.x_m - origin.x_m) * scale - 0.5, (point.y_m - origin.y_m) * scale - 0.5);
        let inside = x >= 0.0
            && y >= 0.0
            && x < f32::from(self.geometry.width()) - 1.0
            && y < f32::from(self.geometry.height()) - 1.0;
        if !inside {
            return FieldSample::default();
        }
        // Both are positive here: truncation is floor.
        let (column, row) = (saturating_i32(x), saturating_i32(y));
        let [[low_left, low_right], [high_left, high_right]] = self.square(column, row);
        let (low_left, low_right) = (f32::from(low_left), f32::from(low_right));
        let (high_left, high_right) = (f32::from(high_left), f32::from(high_right));
        let (share_x, share_y) = (x - nearest_f32(column), y - nearest_f32(row));
        let (low, high) = (low_right - low_left, high_right - high_left);
        let (left, right) = (high_left - low_left, high_right - low_right);
        let value = low_left + share_x * low + share_y * (left + share_x * (right - left));
        let scale = scale / 255.0;
        FieldSample {
            value: value / 255.0,
            slope_x: (low + share_y * (high - low)) * scale,
            slope_y: (left + share_x * (right - left)) * scale,
        }
    }

    /// The values of a cell, of the one beside it and of both above them.
    #[inline]
    fn square(&self, column: i32, row: i32) -> [[u8; 2]; 2] {
        let values = |first: usize| self.values.get(first..).and_then(<[u8]>::first_chunk::<2>).copied();
        let last = self.part.index(column.saturating_add(1), row.saturating_add(1));
        if let Some((first, last)) = self.part.index(column, row).zip(last)
            && let Some((low, high)) = values(first).zip(values(last.saturating_sub(1)))
        {
            return [low, high];
        }
        // Across the rim of what is stored.
        let at = |right: i32, up: i32| self.at(column.saturating_add(right), row.saturating_add(up));
        [[at(0, 0), at(1, 0)], [at(0, 1), at(1, 1)]]
    }
}
