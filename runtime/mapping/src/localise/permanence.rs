//! What of a map is long and straight: walls and racks stand for years, chairs and pallets for hours.

use floorguard_mapping::Occupancy;

use crate::grid_map::GridMap;

/// What is straight over no more than this may have been moved, metres...
const FURNITURE_M: f64 = 2.0;
/// ... and over this stands as it stood.
const WALL_M: f64 = 4.0;
/// Directions that are tried, over half a turn.
const DIRECTIONS: u32 = 36;

/// The straight pieces of occupied cells in a grid. Gaps and bends of a cell do not end a piece.
pub struct StraightPieces {
    solid: Vec<bool>,
    columns: i64,
    rows: i64,
    cell_m: f64,
    /// Cells of the longest piece that is distinguished.
    most: i64,
    directions: Vec<[f64; 2]>,
}

impl StraightPieces {
    /// Of the occupied cells of a grid.
    pub fn new(map: &GridMap) -> Self {
        Self {
            solid: thickened(map),
            columns: map.columns as i64,
            rows: map.rows as i64,
            cell_m: map.cell_m,
            most: (WALL_M / map.cell_m).ceil().clamp(1.0, 10_000.0) as i64,
            directions: (0..DIRECTIONS).map(unit).collect(),
        }
    }

    /// How surely what stands in a cell stays, 0 to 1, by the longest straight piece through it. Cost: 36 directions of up to four metres.
    pub fn permanence_at(&self, cell: [i64; 2]) -> f64 {
        let mut longest = 0;
        for [x, y] in &self.directions {
            longest = longest.max(self.reach(cell, [*x, *y]) + 1 + self.reach(cell, [-x, -y]));
            if longest >= self.most {
                break;
            }
        }
        ((longest as f64 * self.cell_m - FURNITURE_M) / (WALL_M - FURNITURE_M)).clamp(0.0, 1.0)
    }

    /// Solid cells from a cell on along a direction.
    fn reach(&self, from: [i64; 2], [along_x, along_y]: [f64; 2]) -> i64 {
        let is_solid = |step: &i64| {
            let step = *step as f64;
            let column = from[0] + (step * along_x).round() as i64;
            let row = from[1] + (step * along_y).round() as i64;
            let is_inside = (0..self.columns).contains(&column) && (0..self.rows).contains(&row);
            is_inside && self.solid[(row * self.columns + column) as usize]
        };
        (1..self.most).take_while(is_solid).count() as i64
    }
}

/// How surely each cell of a map belongs to something that stays: 0 furniture or floor, 255 a long wall. Only cells that a beam meets
/// first are asked: the inside of a thick wall has 0.
pub fn permanence(map: &GridMap) -> Vec<u8> {
    let pieces = StraightPieces::new(map);
    let of_cell = |index: usize| {
        if !is_face(map, index) {
            return 0;
        }
        let cell = [(index % map.columns) as i64, (index / map.columns) as i64];
        (255.0 * pieces.permanence_at(cell)) as u8
    };
    (0..map.cells.len()).map(of_cell).collect()
}

/// An occupied cell that a beam can reach: the inside of thick walls explains nothing.
pub(super) fn is_face(map: &GridMap, index: usize) -> bool {
    let (column, row) = ((index % map.columns) as i64, (index / map.columns) as i64);
    let around = [(-1, 0), (1, 0), (0, -1), (0, 1)];
    map.at(column, row) == Occupancy::Occupied
        && around.iter().any(|(x, y)| map.at(column + x, row + y) != Occupancy::Occupied)
}

/// One direction of the half turn.
fn unit(direction: u32) -> [f64; 2] {
    let angle_rad = std::f64::consts::PI * f64::from(direction) / f64::from(DIRECTIONS);
    [libm::cos(angle_rad), libm::sin(angle_rad)]
}

/// Cells that are occupied, or have an occupied neighbour.
fn thickened(map: &GridMap) -> Vec<bool> {
    let mut solid = vec![false; map.cells.len()];
    for index in (0..map.cells.len()).filter(|index| map.cells[*index] == Occupancy::Occupied) {
        let (column, row) = (index % map.columns, index / map.columns);
        for y in row.saturating_sub(1)..(row + 2).min(map.rows) {
            for x in column.saturating_sub(1)..(column + 2).min(map.columns) {
                solid[y * map.columns + x] = true;
            }
        }
    }
    solid
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A map of 8 × 8 m with what is true of the middle of its cells.
    fn map(is_solid: impl Fn(f64, f64) -> bool) -> GridMap {
        let state = |index: usize| {
            let (x, y) = ((index % 160) as f64, (index / 160) as f64);
            let is_solid = is_solid(0.05 * (x + 0.5), 0.05 * (y + 0.5));
            if is_solid { Occupancy::Occupied } else { Occupancy::Free }
        };
        let cells = (0..160 * 160).map(state).collect();
        GridMap { columns: 160, rows: 160, cell_m: 0.05, corner_m: [0.0, 0.0], cells }
    }

    fn mean(map: &GridMap) -> f64 {
        let faces = (0..map.cells.len()).filter(|index| is_face(map, *index)).count();
        permanence(map).iter().map(|value| f64::from(*value) / 255.0).sum::<f64>() / faces as f64
    }

    #[test]
    fn thin_walls_of_any_direction_stay() {
        for step in 0..36 {
            let (sin, cos) = (std::f64::consts::PI * f64::from(step) / 36.0).sin_cos();
            let wall = map(|x, y| {
                let (x, y) = (x - 4.0, y - 4.0);
                (cos * x + sin * y).abs() < 2.5 && (cos * y - sin * x).abs() < 0.04
            });
            assert!(mean(&wall) > 0.8, "{step}: {}", mean(&wall));
        }
    }

    #[test]
    fn furniture_beside_a_wall_may_go() {
        let cupboard = |x: f64, y: f64| (2.0..3.2).contains(&x) && (0.1..0.7).contains(&y);
        assert_eq!(mean(&map(cupboard)), 0.0);
        let values = permanence(&map(|x, y| y < 0.1 || cupboard(x, y)));
        assert!(values[160..200].iter().all(|value| *value == 255), "the wall");
        let front = &values[8 * 160..];
        assert!(front.iter().all(|value| *value < 64), "{:?}", front.iter().max());
    }
}
