//! A scene out of an occupancy map: whatever is occupied stands from the floor up.

use floorguard_types::geometry::Point2;

use super::{Material, SceneBuilder};

/// Cells of a map that are occupied, row by row from the lower left corner.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct OccupiedCells {
    /// Lower left corner of the first cell, world frame, metres.
    pub origin_m: [f32; 2],
    /// Edge of a cell, metres.
    pub resolution_m: f32,
    /// Cells in a row.
    pub width: usize,
    /// One per cell.
    pub occupied: Vec<bool>,
}

/// First column and row, and how many of both.
type Rectangle = [usize; 4];

impl OccupiedCells {
    /// Adds the cells as boxes of this height.
    pub fn build(&self, height_m: f32, builder: &mut SceneBuilder) {
        for [low, high] in self.boxes() {
            let size = (high.x_m - low.x_m, high.y_m - low.y_m);
            let place = (low.x_m + size.0 / 2.0, low.y_m + size.1 / 2.0, 0.0);
            builder.cuboid(place, size, (0.0, height_m), Material::Matte);
        }
    }

    /// The boxes from above: lower left and upper right corner, world frame.
    #[must_use]
    pub fn boxes(&self) -> Vec<[Point2; 2]> {
        let corner = |column: usize, row: usize| {
            Point2::new(
                self.origin_m[0] + column as f32 * self.resolution_m,
                self.origin_m[1] + row as f32 * self.resolution_m,
            )
        };
        let rectangles = self.rectangles().into_iter();
        rectangles
            .map(|[column, row, columns, rows]| [corner(column, row), corner(column + columns, row + rows)])
            .collect()
    }

    /// Covers the occupied cells with rectangles, each cell once: runs along the row, then as many equal rows as follow.
    fn rectangles(&self) -> Vec<Rectangle> {
        let width = self.width.max(1);
        let mut left = self.occupied.clone();
        let mut found = Vec::new();
        for start in 0..left.len() {
            if !left[start] {
                continue;
            }
            let (column, row) = (start % width, start / width);
            let columns =
                left[start..(row + 1) * width.min(left.len())].iter().take_while(|cell| **cell).count();
            let whole = |below: &usize| {
                let first = below * width + column;
                left.get(first..first + columns).is_some_and(|run| run.iter().all(|cell| *cell))
            };
            let rows = (row..).take_while(whole).count();
            for below in row..row + rows {
                left[below * width + column..][..columns].fill(false);
            }
            found.push([column, row, columns, rows]);
        }
        found
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use parry3d::math::Vector;

    fn cells(rows: [&str; 4]) -> OccupiedCells {
        let occupied = rows.iter().rev().flat_map(|row| row.bytes().map(|byte| byte == b'#')).collect();
        OccupiedCells { origin_m: [-1.0, 2.0], resolution_m: 0.5, width: rows[0].len(), occupied }
    }

    #[test]
    fn every_occupied_cell_is_covered_exactly_once() {
        let map = cells(["######", "#....#", "#.##.#", "######"]);
        let rectangles = map.rectangles();
        let mut covered = vec![0; map.occupied.len()];
        for [column, row, columns, rows] in &rectangles {
            for cell in
                (*row..row + rows).flat_map(|row| (*column..column + columns).map(move |c| row * 6 + c))
            {
                covered[cell] += 1;
            }
        }
        assert!(covered.iter().zip(&map.occupied).all(|(count, occupied)| *count == i32::from(*occupied)));
        assert!(rectangles.len() <= 5, "{rectangles:?}");
    }

    #[test]
    fn beam_ends_at_the_map_wall() {
        let mut builder = SceneBuilder::default();
        cells(["######", "#....#", "#....#", "######"]).build(2.0, &mut builder);
        let scene = builder.build();
        // The room is free from x = -0.5 to 1.5 m and y = 2.5 to 3.5 m.
        let hit = scene.cast(Vector::new(0.0, 3.0, 1.0), Vector::X, 9.0).unwrap();
        assert!((hit.range_m - 1.5).abs() < 1e-4, "{hit:?}");
        let (_, gap_m) = scene.nearest_obstacle(Point2::new(0.0, 3.0)).unwrap();
        assert!((gap_m - 0.5).abs() < 1e-4, "{gap_m}");
    }
}
