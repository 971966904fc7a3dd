//! A finished map as it is searched.

use floorguard_mapping::match_field::{FieldLevel, MatchField, coarsen};
use floorguard_mapping::{GridGeometry, GridSides, Occupancy};
use floorguard_types::geometry::{Point2, Pose2};

use super::config::LocaliseConfig;
use crate::grid_map::GridMap;
use crate::se2::Se2;

/// Levels of the searched field: the coarsest bounds 64 × 64 cells.
const LEVELS: u8 = 6;
/// A return this much behind a wall of the map means that the beam went through it, metres.
const BEHIND_M: f64 = 0.5;

/// A map and the field of its walls.
pub struct KnownMap {
    map: GridMap,
    geometry: GridGeometry,
    levels: Vec<Vec<u8>>,
}

impl KnownMap {
    /// Prepares a map; `None` if it has no wall or is too large for cells numbered in 32 bits.
    #[must_use]
    pub fn new(map: GridMap, config: &LocaliseConfig) -> Option<Self> {
        let cell_m = config.cell_m.max(map.cell_m as f32);
        let margin_m = config.reach_m + cell_m;
        let side = |cells: usize| ((cells as f64 * map.cell_m) as f32 + 2.0 * margin_m) / cell_m;
        let sides =
            GridSides { columns: side(map.columns).ceil() as u32, rows: side(map.rows).ceil() as u32 };
        let corner = map.corner_m.map(|value| value as f32 - margin_m);
        let geometry = GridGeometry::with_sides(sides, cell_m, Point2::new(corner[0], corner[1]))?;
        let count = geometry.cell_count();
        let mut field =
            MatchField::new(geometry, [vec![0_u8; count], vec![0_u8; count]], config.reach_m).ok()?;
        let mut walls = 0_usize;
        for index in (0..map.cells.len()).filter(|index| is_face(&map, *index)) {
            let [x_m, y_m] = map.centre_m(index);
            field.insert(Point2::new(x_m as f32, y_m as f32));
            walls += 1;
        }
        let mut levels = vec![field.levels()[0].values.to_vec()];
        for shift in 0..LEVELS {
            let mut coarser = vec![0_u8; count];
            coarsen(FieldLevel { geometry, values: &levels[usize::from(shift)], shift }, &mut coarser);
            levels.push(coarser);
        }
        (walls > 0).then_some(Self { map, geometry, levels })
    }

    /// The map.
    #[must_use]
    pub const fn map(&self) -> &GridMap {
        &self.map
    }

    /// The levels, fine first.
    #[must_use]
    pub fn levels(&self) -> Vec<FieldLevel<'_>> {
        let mut levels = Vec::new();
        for (shift, values) in (0..).zip(&self.levels) {
            levels.push(FieldLevel { geometry: self.geometry, values, shift });
        }
        levels
    }

    /// The middle of the map, heading 0.
    pub(super) fn centre(&self) -> Pose2 {
        let centre = |axis: usize, count: usize| {
            (self.map.corner_m[axis] + 0.5 * count as f64 * self.map.cell_m) as f32
        };
        Pose2::new(centre(0, self.map.columns), centre(1, self.map.rows), 0.0)
    }

    /// Cells of the field from the middle to the farther edge.
    pub(super) fn half_side_cells(&self) -> i32 {
        (self.geometry.columns().max(self.geometry.rows()) / 2 + 1) as i32
    }

    /// A beam from a pose of the map to a return went through a wall.
    pub(super) fn goes_through(&self, pose: Se2, point: Point2) -> bool {
        let [x_m, y_m] = pose.transform(point);
        let length_m = pose.distance(Se2::new(x_m, y_m, 0.0));
        let steps = ((length_m - BEHIND_M) / self.map.cell_m).floor();
        if steps < 1.0 {
            return false;
        }
        let step = self.map.cell_m / length_m;
        (1..=steps as u32).any(|at| {
            let share = f64::from(at) * step;
            let [column, row] =
                self.map.cell_of([pose.x_m + share * (x_m - pose.x_m), pose.y_m + share * (y_m - pose.y_m)]);
            self.map.at(column, row) == Occupancy::Occupied
        })
    }
}

/// An occupied cell that a beam can reach: the inside of thick walls explains nothing.
fn is_face(map: &GridMap, index: usize) -> bool {
    let (column, row) = ((index % map.columns) as i64, (index / map.columns) as i64);
    let around = [(-1, 0), (1, 0), (0, -1), (0, 1)];
    map.at(column, row) == Occupancy::Occupied
        && around.iter().any(|(x, y)| map.at(column + x, row + y) != Occupancy::Occupied)
}
