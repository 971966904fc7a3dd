//! Artificial floors: the two of the published protocol, and a supermarket.

use floorguard_mapping::{Grid, GridCoordinates, GridGeometry, Occupancy};
use floorguard_types::geometry::Point2;

use super::ros_map::OccupancyMap;

const PIXEL_M: f32 = 0.05;

/// A rectangle of free floor inside walls of 0.1 m.
fn room(wide_m: f32, high_m: f32) -> anyhow::Result<OccupancyMap> {
    let pixels = |m: f32| (m / PIXEL_M).round() as u16 + 4;
    let corner = Point2::new(-2.0 * PIXEL_M, -2.0 * PIXEL_M);
    let geometry = GridGeometry::new(pixels(wide_m), pixels(high_m), PIXEL_M, corner)
        .ok_or_else(|| anyhow::anyhow!("a room of {wide_m} m × {high_m} m is too small for a map"))?;
    let mut map = Grid::new(geometry, vec![Occupancy::Occupied; geometry.cell_count()])?;
    fill(&mut map, (0.0, 0.0, wide_m, high_m), Occupancy::Free);
    Ok(map)
}

/// Fills a rectangle given by its smallest and largest corner, metres.
fn fill(map: &mut OccupancyMap, (x0, y0, x1, y1): (f32, f32, f32, f32), state: Occupancy) {
    let geometry = *map.geometry();
    for (index, cell) in map.values_mut().iter_mut().enumerate() {
        let centre = geometry.centre(index);
        if centre.x_m > x0 && centre.x_m < x1 && centre.y_m > y0 && centre.y_m < y1 {
            *cell = state;
        }
    }
}

/// 4.2 m × 3.6 m without anything in it: as much floor as the published robot cleaned (about 12 m²; book, Cleaning:
/// Published protocol).
///
/// # Errors
/// None in practice: the sizes are fixed.
pub fn laboratory() -> anyhow::Result<OccupancyMap> {
    room(4.2, 3.6)
}

/// Cuts a rectangle out of a map, given by its smallest and largest corner in metres, and closes it with a wall.
///
/// # Errors
/// A rectangle that is empty or does not lie within the map.
pub fn cut_out(map: &OccupancyMap, low: Point2, high: Point2) -> anyhow::Result<OccupancyMap> {
    let fine = map.geometry();
    let pixel_m = fine.resolution_m();
    let pixels = |from: f32, to: f32| ((to - from) / pixel_m).round().clamp(0.0, 65_535.0) as u16;
    let geometry = GridGeometry::new(pixels(low.x_m, high.x_m), pixels(low.y_m, high.y_m), pixel_m, low);
    let geometry = geometry.ok_or_else(|| anyhow::anyhow!("nothing to cut out of the map"))?;
    let mut part = Grid::new(geometry, vec![Occupancy::Occupied; geometry.cell_count()])?;
    let (last_column, last_row) = (i32::from(geometry.width()) - 1, i32::from(geometry.height()) - 1);
    for (index, cell) in part.values_mut().iter_mut().enumerate() {
        let GridCoordinates { column, row } = geometry.coordinates(index);
        let source = fine.cell_at(geometry.centre(index)).and_then(|i| map.get(i));
        let source = source.ok_or_else(|| anyhow::anyhow!("the cut reaches beyond the map"))?;
        if column > 0 && row > 0 && column < last_column && row < last_row {
            *cell = *source;
        }
    }
    Ok(part)
}

/// 6 m × 4 m without anything in it (book, Cleaning: Published protocol).
///
/// # Errors
/// None in practice: the sizes are fixed.
pub fn plain() -> anyhow::Result<OccupancyMap> {
    room(6.0, 4.0)
}

/// 6 m × 4 m with a wall that has a door, and furniture.
///
/// # Errors
/// None in practice: the sizes are fixed.
pub fn furnished() -> anyhow::Result<OccupancyMap> {
    let mut map = room(6.0, 4.0)?;
    for part in [
        (3.4, 0.0, 3.5, 1.5),
        (3.4, 2.5, 3.5, 4.0),
        (0.8, 2.9, 2.0, 3.5),
        (1.4, 0.9, 1.8, 1.3),
        (4.6, 1.0, 5.2, 1.9),
        (5.4, 3.2, 6.0, 4.0),
    ] {
        fill(&mut map, part, Occupancy::Occupied);
    }
    Ok(map)
}

/// 15 m × 10 m with four rows of shelves: aisles of 1.6 m and cross aisles at both ends.
///
/// # Errors
/// None in practice: the sizes are fixed.
pub fn supermarket() -> anyhow::Result<OccupancyMap> {
    let mut map = room(15.0, 10.0)?;
    for shelf in 0..4_u8 {
        let low = 1.6 + f32::from(shelf) * 2.2;
        fill(&mut map, (2.0, low, 6.8, low + 0.6), Occupancy::Occupied);
        fill(&mut map, (8.4, low, 13.0, low + 0.6), Occupancy::Occupied);
    }
    Ok(map)
}
