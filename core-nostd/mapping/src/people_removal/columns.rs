//! A sweep seen from above: what stands in columns of 0.1 m, and which columns belong together.

use floorguard_types::geometry::{Point2, Point3};
use floorguard_types::number::{nearest_f32, truncating_i32, truncating_u32, truncating_usize};

use super::free_space::floor;

/// A column above a square of the floor.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Column {
    /// Returns of the sweep at the height of people.
    pub(super) points: u16,
    /// Those of them that lie in free space.
    pub(super) free: u16,
    pub(super) mark: Mark,
}

/// What a column belongs to.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) enum Mark {
    #[default]
    None,
    /// Has been looked at, stays.
    Visited,
    /// Beside what moved: what is known to stand stays.
    Beside,
    /// Moved.
    Moved,
}

/// The storage has fewer columns than the grid.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ColumnGridTooSmall {
    /// Columns needed.
    pub needed: usize,
}

/// A square grid of columns around the sensor, over storage that is handed in.
#[derive(Clone, Debug)]
pub struct ColumnGrid<C> {
    columns: C,
    side: u16,
    corner_in_map: Point2,
}

/// Edge of a column, metres.
pub(super) const COLUMN_M: f32 = 0.1;
/// Columns of the largest grid: its side has 16 bits.
const COLUMNS_MAX: u32 = 65_535 * 65_535;
/// Columns along an axis to the farthest neighbour that is asked for.
const REACH_MAX: i32 = 64;
/// Columns of a part; a larger one is cut, and what is cut off is a part of its own.
pub(super) const MEMBERS: usize = 2_048;

/// Columns that touch each other.
pub(super) type Members = heapless::Vec<u32, MEMBERS>;

impl<C: AsRef<[Column]> + AsMut<[Column]>> ColumnGrid<C> {
    /// A grid of `side` × `side` columns of 0.1 m; 400 reach 20 m.
    ///
    /// # Errors
    /// The storage is smaller.
    pub fn new(side: u16, columns: C) -> Result<Self, ColumnGridTooSmall> {
        let needed = usize::from(side).saturating_mul(usize::from(side));
        if columns.as_ref().len() < needed {
            return Err(ColumnGridTooSmall { needed });
        }
        Ok(Self { columns, side, corner_in_map: Point2::new(0.0, 0.0) })
    }

    /// Empties all columns and lays the grid around a place of the map.
    pub(super) fn centre_on(&mut self, place: Point3) {
        self.columns.as_mut().fill(Column::default());
        let half_m = 0.5 * COLUMN_M * nearest_f32(self.side);
        self.corner_in_map = Point2::new(place.x_m - half_m, place.y_m - half_m);
    }

    /// Number of the column of a point; `None` outside.
    #[inline]
    pub(super) fn number(&self, point: Point3) -> Option<u32> {
        let column = floor((point.x_m - self.corner_in_map.x_m) * (1.0 / COLUMN_M));
        let row = floor((point.y_m - self.corner_in_map.y_m) * (1.0 / COLUMN_M));
        self.number_at(column, row)
    }

    #[inline]
    fn number_at(&self, column: i32, row: i32) -> Option<u32> {
        let side = i32::from(self.side);
        let is_inside = (0..side).contains(&column) && (0..side).contains(&row);
        is_inside.then(|| truncating_u32(row.wrapping_mul(side).wrapping_add(column)))
    }

    #[inline]
    pub(super) fn get(&self, number: u32) -> Column {
        self.columns.as_ref().get(truncating_usize(number)).copied().unwrap_or_default()
    }

    #[inline]
    pub(super) fn get_mut(&mut self, number: u32) -> Option<&mut Column> {
        self.columns.as_mut().get_mut(truncating_usize(number))
    }

    /// All numbers.
    pub(super) fn numbers(&self) -> core::ops::Range<u32> {
        0..u32::from(self.side).saturating_mul(u32::from(self.side)).min(COLUMNS_MAX)
    }

    /// Columns at most `reach` away along each axis, the column itself among them.
    pub(super) fn around(&self, number: u32, reach: i32) -> impl Iterator<Item = u32> + use<C> {
        let side = u32::from(self.side).max(1);
        let (column, row) = (truncating_i32(number % side), truncating_i32(number / side));
        let width = i32::from(self.side);
        let inside = move |value: i32| (0..width).contains(&value);
        (-reach..=reach.min(REACH_MAX))
            .flat_map(move |up| (-reach..=reach.min(REACH_MAX)).map(move |right| (column + right, row + up)))
            .filter(move |(column, row)| inside(*column) && inside(*row))
            .map(move |(column, row)| truncating_u32(row.wrapping_mul(width).wrapping_add(column)))
    }

    /// Collects the columns that hang together with `first` by `belongs`, which is asked of each only once; all of them are
    /// marked as visited.
    pub(super) fn part(&mut self, first: u32, belongs: impl Fn(&Column) -> bool, members: &mut Members) {
        members.clear();
        self.take_in(first, members);
        for head in 0..MEMBERS {
            let Some(number) = members.get(head).copied() else { break };
            for other in self.around(number, 1) {
                let column = self.get(other);
                if column.mark == Mark::None && belongs(&column) {
                    self.take_in(other, members);
                }
            }
        }
    }

    fn take_in(&mut self, number: u32, members: &mut Members) {
        if members.push(number).is_ok()
            && let Some(column) = self.get_mut(number)
        {
            column.mark = Mark::Visited;
        }
    }
}
