//! Changes to a finished map: a part of it, turned to its walls, without what was there by chance, with zones that are not driven.

use floorguard_mapping::Occupancy;

use super::grid::GridMap;

/// A polygon of the map, metres; its last corner joins its first.
#[derive(Clone, Debug, PartialEq)]
pub struct Zone(pub Vec<[f64; 2]>);

impl Zone {
    /// Whether a place lies in it; a crossing of its edges is outside (even-odd rule).
    #[must_use]
    pub fn contains(&self, [x, y]: [f64; 2]) -> bool {
        let mut inside = false;
        for (index, &[ax, ay]) in self.0.iter().enumerate() {
            let [bx, by] = self.0[(index + 1) % self.0.len()];
            if (ay > y) != (by > y) && x < ax + (bx - ax) * (y - ay) / (by - ay) {
                inside = !inside;
            }
        }
        inside
    }
}

impl GridMap {
    /// The cells whose centres lie between two corners; `None` if there are none.
    #[must_use]
    pub fn cropped(&self, [a, b]: [[f64; 2]; 2]) -> Option<Self> {
        let span = |axis: usize, count: usize| {
            let (low, high) = (a[axis].min(b[axis]), a[axis].max(b[axis]));
            let centre = |cell: usize| self.corner_m[axis] + (cell as f64 + 0.5) * self.cell_m;
            let first = (0..count).find(|cell| centre(*cell) >= low)?;
            let last = (first..count).take_while(|cell| centre(*cell) <= high).last()?;
            Some([first, last + 1])
        };
        let ([left, right], [bottom, top]) = (span(0, self.columns)?, span(1, self.rows)?);
        let rows =
            (bottom..top).flat_map(|row| &self.cells[row * self.columns + left..row * self.columns + right]);
        Some(Self {
            columns: right - left,
            rows: top - bottom,
            cell_m: self.cell_m,
            corner_m: [
                self.corner_m[0] + left as f64 * self.cell_m,
                self.corner_m[1] + bottom as f64 * self.cell_m,
            ],
            cells: rows.copied().collect(),
        })
    }

    /// Sets all cells whose centres lie in a zone; answers how many changed.
    pub fn fill(&mut self, zone: &Zone, state: Occupancy) -> usize {
        let inside: Vec<usize> =
            (0..self.cells.len()).filter(|index| zone.contains(self.centre_m(*index))).collect();
        let mut changed = 0;
        for index in inside {
            changed += usize::from(self.cells[index] != state);
            self.cells[index] = state;
        }
        changed
    }

    /// A map of the same size in which the zones are occupied and all else is free: a mask for planners.
    #[must_use]
    pub fn mask(&self, zones: &[Zone]) -> Self {
        let mut mask = Self { cells: vec![Occupancy::Free; self.cells.len()], ..self.clone() };
        for zone in zones {
            mask.fill(zone, Occupancy::Occupied);
        }
        mask
    }

    /// The map turned counter-clockwise about its origin. A cell takes the state of the old one in whose place it lies, and where
    /// free floor would touch the unknown through a hole in a wall, the wall is drawn through.
    #[must_use]
    pub fn turned(&self, by_rad: f64) -> Self {
        let (sin, cos) = libm::sincos(by_rad);
        let forward = |[x, y]: [f64; 2]| [cos * x - sin * y, sin * x + cos * y];
        let back = |[x, y]: [f64; 2]| [cos * x + sin * y, cos * y - sin * x];
        let end = |axis: usize, count: usize| self.corner_m[axis] + count as f64 * self.cell_m;
        let (left, bottom) = (self.corner_m[0], self.corner_m[1]);
        let (right, top) = (end(0, self.columns), end(1, self.rows));
        let corners = [[left, bottom], [right, bottom], [right, top], [left, top]].map(forward);
        let low = |axis: usize| corners.iter().map(|corner| corner[axis]).fold(f64::INFINITY, f64::min);
        let high = |axis: usize| corners.iter().map(|corner| corner[axis]).fold(f64::NEG_INFINITY, f64::max);
        let side = |axis: usize| (((high(axis) - low(axis)) / self.cell_m).ceil() as usize).max(1);
        let mut map = Self {
            columns: side(0),
            rows: side(1),
            cell_m: self.cell_m,
            corner_m: [low(0), low(1)],
            cells: Vec::new(),
        };
        let state = |index: usize| {
            let [column, row] = self.cell_of(back(map.centre_m(index)));
            self.at(column, row)
        };
        map.cells = (0..map.columns * map.rows).map(state).collect();
        let is_leak = |index: usize| {
            let (column, row) = ((index % map.columns) as i64, (index / map.columns) as i64);
            let beside = [(1, 0), (-1, 0), (0, 1), (0, -1)].map(|(x, y)| map.at(column + x, row + y));
            let [column, row] = self.cell_of(back(map.centre_m(index)));
            let near = (0..9).map(|cell| self.at(column + cell % 3 - 1, row + cell / 3 - 1));
            map.cells[index] == Occupancy::Free
                && beside.contains(&Occupancy::Unknown)
                && near.into_iter().any(|state| state == Occupancy::Occupied)
        };
        let leaks: Vec<usize> = (0..map.cells.len()).filter(|index| is_leak(*index)).collect();
        for index in leaks {
            map.cells[index] = Occupancy::Occupied;
        }
        map
    }

    /// How far the map must be turned so that most of its walls run along its axes, −45° to 45°, radians; 0 without walls. The
    /// turn at which the occupied cells fall into the fewest rows and columns.
    #[must_use]
    pub fn turn_to_walls_rad(&self) -> f64 {
        let walls: Vec<[f64; 2]> = (0..self.cells.len())
            .filter(|index| self.cells[*index] == Occupancy::Occupied)
            .map(|index| self.centre_m(index))
            .collect();
        if walls.is_empty() {
            return 0.0;
        }
        let mut best = 0.0;
        for (half, step) in TURNS_DEG {
            let steps = (half / step) as i32;
            let turn = |index: i32| best + f64::from(index) * step;
            let scored = (-steps..=steps).map(|index| (turn(index), self.gathering(&walls, turn(index))));
            // Of equals the smaller turn.
            let better = |a: &(f64, u64), b: &(f64, u64)| a.1.cmp(&b.1).then(b.0.abs().total_cmp(&a.0.abs()));
            best = scored.max_by(better).map_or(best, |(turn, _)| turn);
        }
        best.to_radians()
    }

    /// Sum of the squares of the walls in each row and in each column after a turn.
    fn gathering(&self, walls: &[[f64; 2]], turn_deg: f64) -> u64 {
        let (sin, cos) = libm::sincos(turn_deg.to_radians());
        let mut counts = [std::collections::HashMap::new(), std::collections::HashMap::new()];
        for &[x, y] in walls {
            for (count, value) in counts.iter_mut().zip([cos * x - sin * y, sin * x + cos * y]) {
                *count.entry((value / self.cell_m).floor() as i64).or_insert(0_u64) += 1;
            }
        }
        counts.iter().flat_map(|count| count.values()).map(|count| count * count).sum()
    }
}

/// Turns that are tried: half the window and the step, each about the best of the one before, degrees.
const TURNS_DEG: [(f64, f64); 3] = [(45.0, 0.5), (0.5, 0.1), (0.1, 0.02)];

#[cfg(test)]
mod tests {
    use super::*;

    /// A hall of 12 × 7 m with walls of one cell, turned by some angle.
    fn hall(turned_deg: f64) -> GridMap {
        let (columns, rows) = (300, 260);
        let mut map = GridMap {
            columns,
            rows,
            cell_m: 0.05,
            corner_m: [-7.0, -6.5],
            cells: vec![Occupancy::Unknown; columns * rows],
        };
        let (sin, cos) = turned_deg.to_radians().sin_cos();
        for index in 0..map.cells.len() {
            let [x, y] = map.centre_m(index);
            let (x, y) = (cos * x + sin * y, cos * y - sin * x);
            let inside = (x.abs() - 6.0).max(y.abs() - 3.5);
            map.cells[index] = match inside {
                d if d < -0.05 => Occupancy::Free,
                d if d < 0.0 => Occupancy::Occupied,
                _ => Occupancy::Unknown,
            };
        }
        map
    }

    #[test]
    fn map_is_turned_to_its_walls() {
        for turned_deg in [0.0, 7.3, -31.0] {
            let map = hall(turned_deg);
            let found_deg = map.turn_to_walls_rad().to_degrees();
            assert!((found_deg + turned_deg).abs() < 0.11, "{turned_deg}: {found_deg}");
            let straight = map.turned(map.turn_to_walls_rad());
            let count = |state| straight.cells.iter().filter(|cell| **cell == state).count();
            let at = |x: f64, y: f64| {
                let [column, row] = straight.cell_of([x, y]);
                straight.at(column, row)
            };
            assert_eq!([at(0.0, 0.0), at(5.8, 3.3), at(5.8, -3.3)], [Occupancy::Free; 3]);
            assert_eq!([at(6.3, 0.0), at(0.0, 3.8)], [Occupancy::Unknown; 2]);
            // The walls have no hole: no free cell has an unknown neighbour.
            for index in (0..straight.cells.len()).filter(|index| straight.cells[*index] == Occupancy::Free) {
                let (column, row) = ((index % straight.columns) as i64, (index / straight.columns) as i64);
                for (dx, dy) in [(1, 0), (-1, 0), (0, 1), (0, -1)] {
                    assert_ne!(straight.at(column + dx, row + dy), Occupancy::Unknown, "{turned_deg}");
                }
            }
            assert!((count(Occupancy::Free) as f64 / (11.9 * 6.9 / 0.0025) - 1.0).abs() < 0.03);
        }
    }

    #[test]
    fn crop_and_zones_change_the_cells_within() {
        let mut map = hall(0.0);
        let part = map.cropped([[1.0, -1.0], [-2.0, 1.5]]).unwrap();
        assert_eq!((part.columns, part.rows), (60, 50));
        assert!((part.corner_m[0] + 2.0).abs() < 1e-9 && (part.corner_m[1] + 1.0).abs() < 1e-9);
        assert!(part.cells.iter().all(|cell| *cell == Occupancy::Free));
        assert_eq!(map.cropped([[50.0, 0.0], [60.0, 1.0]]), None);
        // A triangle of half a square metre.
        let zone = Zone(vec![[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]]);
        let changed = map.fill(&zone, Occupancy::Unknown);
        assert!((changed as f64 * 0.0025 - 0.5).abs() < 0.03, "{changed}");
        assert_eq!(map.fill(&zone, Occupancy::Unknown), 0);
        let mask = map.mask(&[zone]);
        assert_eq!(mask.cells.iter().filter(|cell| **cell == Occupancy::Occupied).count(), changed);
        assert!(mask.area_m2(Occupancy::Unknown) < 1e-9);
    }
}
