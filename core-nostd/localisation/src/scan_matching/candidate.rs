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

/// The cells of all points for one turn, and the corners of the square that holds them.
#[derive(Clone, Copy, Debug)]
pub(super) struct TurnedPoints<'a> {
    pub(super) cells: &'a [CellOffset],
    pub(super) low: CellOffset,
    pub(super) high: CellOffset,
}

/// Points between two looks at what is still possible.
const CHUNK: usize = 64;

/// Sum of the values below the points, moved by whole cells; the least number if it cannot exceed `needed`.
pub(super) fn sum_of_values(
    level: &FieldLevel<'_>,
    points: &TurnedPoints<'_>,
    [column, row]: [i32; 2],
    needed: i32,
) -> i32 {
    let moved = |offset: i16, by: i32| i32::from(offset).saturating_add(by);
    // A whole block of cells is stored where two opposite corners are.
    let is_stored =
        |cell: CellOffset| level.part.index(moved(cell.column, column), moved(cell.row, row)).is_some();
    let is_inside = is_stored(points.low) && is_stored(points.high);
    let mut sum = 0_i32;
    let mut left = points.cells.len();
    for cells in points.cells.chunks(CHUNK) {
        let part = if is_inside {
            sum_inside(level, cells, [column, row])
        } else {
            let value = |cell: &CellOffset| level.at(moved(cell.column, column), moved(cell.row, row));
            cells.iter().map(|cell| u32::from(value(cell))).fold(0, u32::saturating_add)
        };
        sum = sum.saturating_add_unsigned(part);
        left = left.saturating_sub(cells.len());
        let most = u32::try_from(left).unwrap_or(u32::MAX).saturating_mul(255);
        if sum.saturating_add_unsigned(most) <= needed {
            return i32::MIN;
        }
    }
    sum
}

/// The same where no point lies outside the field.
#[inline]
fn sum_inside(level: &FieldLevel<'_>, cells: &[CellOffset], [column, row]: [i32; 2]) -> u32 {
    let width = i64::try_from(level.part.columns()).unwrap_or(0);
    let begins = level.part.first;
    let below = i64::from(row).wrapping_sub(i64::from(begins.row));
    let first =
        below.wrapping_mul(width).wrapping_add(i64::from(column)).wrapping_sub(i64::from(begins.column));
    let mut sum = 0_u32;
    for cell in cells {
        let index = i64::from(cell.row).wrapping_mul(width).wrapping_add(i64::from(cell.column));
        let index = usize::try_from(index.wrapping_add(first)).unwrap_or(usize::MAX);
        sum = sum.wrapping_add(u32::from(level.values.get(index).copied().unwrap_or(0)));
    }
    sum
}
