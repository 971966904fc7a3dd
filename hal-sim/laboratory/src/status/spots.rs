//! Dirty cells that touch, as spots.

use floorguard_mapping::{GridCoordinates, GridGeometry};
use floorguard_types::geometry::Point2;
use serde::Serialize;

/// Smallest spot, cells (book, Floor and dirt: Spots).
const CELLS_MIN: usize = 2;
/// Spots in a report at most; the largest first (book, Floor and dirt: Spots).
const SPOTS_MAX: usize = 128;

/// A spot as it was before cleaning, and what became of it.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Spot {
    /// Number in the report, from 1, the largest first.
    pub number: usize,
    /// Middle, in the map, metres.
    pub x_m: f32,
    /// Middle, in the map, metres.
    pub y_m: f32,
    /// Area before, m².
    pub area_m2: f32,
    /// Expected units in a cell before, mean.
    pub units: f32,
    /// Share of its cells that are promised to be clean now.
    pub clean_share: f32,
    #[serde(skip)]
    pub(super) cells: Vec<usize>,
}

/// Connected dirty cells (4 neighbours) of at least two, with all numbers but `clean_share`.
pub fn spots(geometry: &GridGeometry, expected: &[f32], is_dirty: &[bool]) -> Vec<Spot> {
    let mut seen = vec![false; is_dirty.len()];
    let mut all: Vec<Vec<usize>> = Vec::new();
    for start in 0..is_dirty.len() {
        if !is_dirty[start] || seen[start] {
            continue;
        }
        let (mut cells, mut next) = (vec![start], 0);
        seen[start] = true;
        while let Some(&cell) = cells.get(next) {
            next += 1;
            let GridCoordinates { column, row } = geometry.coordinates(cell);
            for (dx, dy) in [(1, 0), (-1, 0), (0, 1), (0, -1)] {
                if let Some(other) = geometry.index(column + dx, row + dy)
                    && is_dirty[other]
                    && !seen[other]
                {
                    seen[other] = true;
                    cells.push(other);
                }
            }
        }
        if cells.len() >= CELLS_MIN {
            all.push(cells);
        }
    }
    all.sort_by_key(|cells| (std::cmp::Reverse(cells.len()), cells[0]));
    let spot = |(index, cells): (usize, Vec<usize>)| {
        let count = cells.len() as f32;
        let sum = |value: &dyn Fn(usize) -> f32| cells.iter().map(|&cell| value(cell)).sum::<f32>() / count;
        let centre = |cell| -> Point2 { geometry.centre(cell) };
        Spot {
            number: index + 1,
            x_m: sum(&|cell| centre(cell).x_m),
            y_m: sum(&|cell| centre(cell).y_m),
            area_m2: count * geometry.resolution_m() * geometry.resolution_m(),
            units: sum(&|cell| expected[cell]),
            clean_share: 0.0,
            cells,
        }
    };
    all.into_iter().take(SPOTS_MAX).enumerate().map(spot).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn touching_cells_are_one_spot() {
        let geometry = GridGeometry::new(6, 3, 0.1, Point2::new(0.0, 0.0)).unwrap();
        let picture = ["##..#.", "#..#..", "....##"];
        let is_dirty: Vec<bool> = picture.iter().flat_map(|row| row.chars().map(|c| c == '#')).collect();
        let expected: Vec<f32> = is_dirty.iter().map(|&dirty| if dirty { 4.0 } else { 0.0 }).collect();
        let all = spots(&geometry, &expected, &is_dirty);
        let sizes: Vec<usize> = all.iter().map(|spot| spot.cells.len()).collect();
        assert_eq!(sizes, [3, 2]);
        assert!(
            (all[1].x_m - 0.5).abs() < 1e-6 && (all[1].area_m2 - 0.02).abs() < 1e-6 && all[1].units == 4.0
        );
    }
}
