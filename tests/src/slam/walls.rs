//! How thick the walls of a map are drawn.

use std::path::Path;

use anyhow::Context as _;

/// Darker is occupied.
const OCCUPIED_MAX: u8 = 100;
/// Half the length of wall that is looked at, cells, and how much of it must be there.
const HALF_CELLS: usize = 25;
const WALL_SHARE: f64 = 0.9;
/// Thicker is no wall of one side, cells.
const WIDEST_CELLS: usize = 25;
/// Rows and columns that are looked at: one of so many.
const EVERY: usize = 7;
/// Edge of a cell, metres.
const CELL_M: f64 = 0.01;

/// Widths of the walls along both axes, metres: so many occupied cells of 1 cm lie side by side, less one, because a surface of no
/// thickness takes one.
///
/// # Errors
/// The picture of the map cannot be read.
pub fn wall_widths_m(map: &Path) -> anyhow::Result<Vec<f64>> {
    let path = map.join("map.pgm");
    let picture = image::open(&path).with_context(|| path.display().to_string())?.into_luma8();
    let (width, height) = (picture.width() as usize, picture.height() as usize);
    let upright = |x: usize, y: usize| {
        let cell = picture.get_pixel_checked(x as u32, y as u32);
        cell.is_some_and(|cell| cell.0[0] < OCCUPIED_MAX)
    };
    let lying = |x: usize, y: usize| upright(y, x);
    let mut widths = widths_cells(&upright, width, height);
    widths.extend(widths_cells(&lying, height, width));
    Ok(widths.into_iter().map(|cells| (cells as f64 - 1.0) * CELL_M).collect())
}

/// Lengths of the occupied runs down a column that belong to a wall across it.
fn widths_cells(is_occupied: &dyn Fn(usize, usize) -> bool, width: usize, height: usize) -> Vec<usize> {
    let mut widths = Vec::new();
    for x in (0..width).step_by(EVERY) {
        let mut from = None;
        for y in 0..=height {
            match (is_occupied(x, y), from) {
                (true, None) => from = Some(y),
                (false, Some(begin)) => {
                    from = None;
                    if y - begin < WIDEST_CELLS && goes_on(is_occupied, x, begin.saturating_sub(2)..y + 2) {
                        widths.push(y - begin);
                    }
                }
                _ => {}
            }
        }
    }
    widths
}

/// The wall is there to both sides of the column.
fn goes_on(is_occupied: &dyn Fn(usize, usize) -> bool, x: usize, rows: std::ops::Range<usize>) -> bool {
    let columns = x.saturating_sub(HALF_CELLS)..=x + HALF_CELLS;
    let count = columns.clone().count();
    let there = columns.filter(|column| rows.clone().any(|row| is_occupied(*column, row))).count();
    there as f64 > WALL_SHARE * count as f64
}
