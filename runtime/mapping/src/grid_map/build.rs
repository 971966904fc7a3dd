//! From scans and poses to a map.

use floorguard_mapping::Occupancy;
use floorguard_types::geometry::Point2;

use super::counts::{CellCounts, CountGrid};
use super::grid::GridMap;
use crate::se2::Se2;

/// How a map is made of beams.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GridMapConfig {
    /// Edge of a cell, metres, > 0.
    pub cell_m: f64,
    /// A cell is occupied if at least this share of its beams ended in it.
    pub occupied_share: f64,
    /// A cell with fewer beams is unknown.
    pub beams_least: u16,
    /// Cells that are added around what was seen.
    pub margin_cells: i32,
}

impl Default for GridMapConfig {
    fn default() -> Self {
        Self { cell_m: 0.05, occupied_share: 0.1, beams_least: 2, margin_cells: 10 }
    }
}

/// A cell along one axis; a scan is never farther from the origin than 2³⁰ cells.
fn cell(value_m: f64, cell_m: f64) -> i32 {
    (value_m / cell_m).floor().clamp(-1.0e9, 1.0e9) as i32
}

/// Makes a map of scans: pose of the scanner in the map, returns in the scanner's frame. `None` without any return.
/// Cost: a step for every cell of every beam.
#[must_use]
pub fn build_grid_map(
    scans: impl Iterator<Item = (Se2, impl AsRef<[Point2]>)>,
    config: &GridMapConfig,
) -> Option<GridMap> {
    let mut counts = CountGrid::default();
    for (pose, points) in scans {
        let from = [cell(pose.x_m, config.cell_m), cell(pose.y_m, config.cell_m)];
        for point in points.as_ref() {
            let [x, y] = pose.transform(*point);
            counts.beam(from, [cell(x, config.cell_m), cell(y, config.cell_m)]);
        }
    }
    let [low, high] = counts.bounds(config.beams_least)?;
    let low = low.map(|value| value - config.margin_cells);
    let side = |axis: usize| (high[axis] + config.margin_cells - low[axis] + 1).max(1) as usize;
    let (columns, rows) = (side(0), side(1));
    let state = |x: usize, y: usize| config.state(counts.at([low[0] + x as i32, low[1] + y as i32]));
    let cells = (0..rows).flat_map(|y| (0..columns).map(move |x| (x, y))).map(|(x, y)| state(x, y)).collect();
    let corner_m = low.map(|value| f64::from(value) * config.cell_m);
    Some(GridMap { columns, rows, cell_m: config.cell_m, corner_m, cells })
}

impl GridMapConfig {
    fn state(&self, CellCounts { hits, passes }: CellCounts) -> Occupancy {
        let beams = hits.saturating_add(passes);
        if beams < self.beams_least.max(1) {
            Occupancy::Unknown
        } else if f64::from(hits) >= self.occupied_share * f64::from(beams) {
            Occupancy::Occupied
        } else {
            Occupancy::Free
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A square room of 4 m around the origin, seen from two places.
    #[test]
    fn room_has_walls_floor_and_no_outside() {
        let wall = |angle: f32| {
            let (sin, cos) = angle.sin_cos();
            let range = 2.02 / sin.abs().max(cos.abs());
            Point2::new(range * cos, range * sin)
        };
        let points: Vec<Point2> = (0..720).map(|i| wall(f32::to_radians(0.5 * i as f32))).collect();
        let turned = Se2::new(0.0, 0.0, std::f64::consts::FRAC_PI_2);
        let scans = [Se2::default(), turned].map(|pose| (pose, points.as_slice()));
        let map = build_grid_map(scans.into_iter(), &GridMapConfig::default()).unwrap();
        let at = |x: f64, y: f64| {
            let [column, row] = map.cell_of([x, y]);
            map.at(column, row)
        };
        assert_eq!(at(0.5, -1.0), Occupancy::Free);
        assert_eq!([at(2.02, 0.3), at(-1.0, -2.02)], [Occupancy::Occupied; 2]);
        assert_eq!([at(2.3, 0.0), at(-9.0, 0.0)], [Occupancy::Unknown; 2]);
        let free_m2 = map.area_m2(Occupancy::Free);
        assert!((15.0..16.4).contains(&free_m2), "{free_m2}");
        assert!(
            build_grid_map(std::iter::empty::<(Se2, [Point2; 0])>(), &GridMapConfig::default()).is_none()
        );
    }
}
