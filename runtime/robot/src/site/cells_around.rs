//! The cells of a raster around a place.

use floorguard_mapping::{GridCoordinates, GridGeometry};
use floorguard_types::geometry::Point2;

/// Cells whose middle is within a distance of a place.
pub fn cells_around(geometry: &GridGeometry, place: Point2, reach_m: f32) -> impl Iterator<Item = usize> {
    let geometry = *geometry;
    let GridCoordinates { column, row } = geometry.coordinates_of(place);
    let reach = (reach_m * geometry.cells_per_metre()).ceil() as i32;
    let offsets = (-reach..=reach).flat_map(move |dy| (-reach..=reach).map(move |dx| (dx, dy)));
    let cells = offsets.filter_map(move |(dx, dy)| geometry.index(column + dx, row + dy));
    cells.filter(move |cell| geometry.centre(*cell).distance(place) <= reach_m)
}
