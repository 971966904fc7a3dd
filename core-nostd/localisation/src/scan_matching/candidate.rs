//! Blocks of poses, and how well the best of a block can fit.

use floorguard_mapping::match_field::FieldLevel;

/// Cell of a point, for one turn.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct CellOffset {
    /// Along x.
    pub column: i16,
    /// Along y.
    pub row: i16,
}

/// A square block of poses with one heading, and the largest score that any of them can have.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Candidate {
    /// Upper bound of the score: sum of the values of all points, less the penalty.
    pub bound: i32,
    /// Steps of the heading from the centre of the window.
    pub turn: i32,
    /// First column of the block, cells from the centre of the window.
    pub column: i32,
    /// First row.
    pub row: i32,
    /// Index of the level that bounds the block; 0 is a single pose.
    pub level: usize,
}

/// Sum of the values below the points, moved by whole cells.
pub(super) fn sum_of_values(level: &FieldLevel<'_>, cells: &[CellOffset], column: i32, row: i32) -> i32 {
    let mut sum = 0_i32;
    for cell in cells {
        let value =
            level.at(i32::from(cell.column).saturating_add(column), i32::from(cell.row).saturating_add(row));
        sum = sum.saturating_add(i32::from(value));
    }
    sum
}
