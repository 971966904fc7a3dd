//! The map of a run for display: what the safety scanner has seen free and occupied, in the odometry frame.
//!
//! It is counted, not estimated: nothing on the robot uses it. Cells stand in tiles, so that a map grows with the
//! path.

use std::collections::BTreeMap;

use floorguard_types::geometry::{Point2, Point3, Pose2, Transform3};
use floorguard_types::sensing::{BeamReturn, Scan};

/// Edge of a cell, metres.
pub const CELL_M: f32 = 0.1;
/// Cells on the side of a tile.
const TILE: i32 = 64;
/// Farther returns are too uncertain for a map, metres.
const RANGE_M: f32 = 20.0;
/// A map is not more cells than this; beyond it, it grows no more: 160 × 160 m.
const TILES_MAX: usize = 625;

/// How often a cell was seen through, and hit.
type Seen = (u16, u16);

/// A map in the making.
#[derive(Clone, Debug, Default)]
pub struct ScanMap {
    tiles: BTreeMap<(i32, i32), Vec<Seen>>,
}

/// A finished picture: −1 unknown, 0 free … 100 occupied.
#[derive(Clone, Debug, PartialEq)]
pub struct MapPicture {
    /// Cells per row.
    pub width: u32,
    /// Lower left corner, in the odometry frame.
    pub origin: Pose2,
    /// Row by row from the origin.
    pub cells: Vec<i8>,
}

impl ScanMap {
    /// A scan of a scanner mounted so, on a robot that was there.
    pub fn add(&mut self, scan: &Scan, mounting: &Transform3, robot: Pose2) {
        let to_odom = |x_m: f32, y_m: f32| {
            let point = mounting.transform(Point3::new(x_m, y_m, 0.0));
            robot.transform(Point2::new(point.x_m, point.y_m))
        };
        let from = to_odom(0.0, 0.0);
        for (index, beam) in scan.beams.iter().enumerate() {
            let (range_mm, hit) = match beam {
                BeamReturn::Hit(range_mm) => (*range_mm, true),
                BeamReturn::Free(range_mm) => (*range_mm, false),
                BeamReturn::Unknown => continue,
            };
            let range_m = f32::from(range_mm) * 1.0e-3;
            let (sin, cos) = libm::sincosf(scan.first_angle_rad + index as f32 * scan.step_rad);
            let seen_m = range_m.min(RANGE_M);
            let to = to_odom(seen_m * cos, seen_m * sin);
            self.see_through(from, to, seen_m);
            if hit && range_m < RANGE_M {
                self.count(to, |seen| seen.1 = seen.1.saturating_add(1));
            }
        }
    }

    fn see_through(&mut self, from: Point2, to: Point2, range_m: f32) {
        let steps = (range_m / CELL_M) as u32;
        for step in 0..steps {
            let share = step as f32 / steps as f32;
            let place = Point2::new(
                (to.x_m - from.x_m).mul_add(share, from.x_m),
                (to.y_m - from.y_m).mul_add(share, from.y_m),
            );
            self.count(place, |seen| seen.0 = seen.0.saturating_add(1));
        }
    }

    fn count(&mut self, place: Point2, count: impl FnOnce(&mut Seen)) {
        let (column, row) = ((place.x_m / CELL_M).floor() as i32, (place.y_m / CELL_M).floor() as i32);
        let key = (row.div_euclid(TILE), column.div_euclid(TILE));
        if self.tiles.len() >= TILES_MAX && !self.tiles.contains_key(&key) {
            return;
        }
        let tile = self.tiles.entry(key).or_insert_with(|| vec![(0, 0); (TILE * TILE) as usize]);
        let index = row.rem_euclid(TILE) * TILE + column.rem_euclid(TILE);
        if let Some(seen) = tile.get_mut(index as usize) {
            count(seen);
        }
    }

    /// The map as it is now; none before the first scan.
    #[must_use]
    pub fn picture(&self) -> Option<MapPicture> {
        let rows = self.tiles.keys().map(|(row, _)| *row);
        let columns = self.tiles.keys().map(|(_, column)| *column);
        let (bottom, top) = (rows.clone().min()?, rows.max()?);
        let (left, right) = (columns.clone().min()?, columns.max()?);
        let (width, height) = ((right - left + 1) * TILE, (top - bottom + 1) * TILE);
        let mut cells = vec![-1_i8; (width * height) as usize];
        for ((row, column), tile) in &self.tiles {
            for (index, seen) in (0..).zip(tile) {
                let (y, x) = ((row - bottom) * TILE + index / TILE, (column - left) * TILE + index % TILE);
                if let Some(cell) = cells.get_mut((y * width + x) as usize) {
                    *cell = occupied_percent(*seen);
                }
            }
        }
        let origin = Pose2::new((left * TILE) as f32 * CELL_M, (bottom * TILE) as f32 * CELL_M, 0.0);
        Some(MapPicture { width: width.unsigned_abs(), origin, cells })
    }
}

/// A wall that is seen at a slant is seen through more often than it is hit.
fn occupied_percent((through, hit): Seen) -> i8 {
    let (through, hit) = (f32::from(through), 3.0 * f32::from(hit));
    if through + hit < 1.0 { -1 } else { (100.0 * hit / (through + hit)) as i8 }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn wall_is_mapped_and_unknown_behind() {
        let mut scan = Scan { first_angle_rad: -0.1, step_rad: 0.01, ..Scan::default() };
        for _ in 0..20 {
            scan.beams.push(BeamReturn::Hit(5_000)).unwrap();
        }
        scan.beams.push(BeamReturn::Unknown).unwrap();
        let mut map = ScanMap::default();
        assert_eq!(map.picture(), None);
        map.add(&scan, &Transform3::IDENTITY, Pose2::new(10.0, -2.0, 0.0));
        let picture = map.picture().unwrap();
        let at = |x_m: f32, y_m: f32| {
            let column = ((x_m - picture.origin.x_m) / CELL_M) as usize;
            let row = ((y_m - picture.origin.y_m) / CELL_M) as usize;
            picture.cells[row * picture.width as usize + column]
        };
        assert_eq!((at(12.05, -1.95), at(16.05, -1.95)), (0, -1));
        let wall = (0..8).map(|step| at(14.75 + 0.05 * step as f32, -1.95)).max();
        assert!(wall.is_some_and(|percent| percent > 50), "{wall:?}");
    }
}
