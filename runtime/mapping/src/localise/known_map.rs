//! A finished map as it is searched.

use floorguard_mapping::match_field::{FieldLevel, FieldPart, MatchField, coarsen};
use floorguard_mapping::{GridGeometry, GridSides, Occupancy};
use floorguard_types::geometry::Point2;

use super::config::LocaliseConfig;
use super::permanence::{is_face, permanence};
use crate::grid_map::GridMap;
use crate::se2::Se2;

/// Levels of the searched field: the coarsest bounds 64 × 64 cells.
const LEVELS: u8 = 6;
/// A return lies on a wall from this value of the field on.
const NEAR_LEAST: u8 = 64;
/// Cells of a beam at most.
const STEPS_MOST: f64 = 4_000.0;

/// What became of a beam in a map.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct BeamFate {
    /// How surely what it went through stays where it is: 0 furniture, 1 a long wall; `None` where the map shows nothing on its way.
    pub crossed: Option<f32>,
    /// Value of the field where it ended; 0 if the map knows nothing there.
    pub end: f32,
    /// Whether the map knows the floor there as free.
    pub ends_on_floor: bool,
}

/// A map and the field of its walls.
pub struct KnownMap {
    map: GridMap,
    geometry: GridGeometry,
    levels: Vec<Vec<u8>>,
    /// How surely each cell of the map stays occupied.
    permanence: Vec<u8>,
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
        let mut levels = vec![field.into_fine()];
        let part = FieldPart::whole(&geometry);
        for shift in 0..LEVELS {
            let mut coarser = vec![0_u8; count];
            coarsen(FieldLevel { geometry, part, values: &levels[usize::from(shift)], shift }, &mut coarser);
            levels.push(coarser);
        }
        let permanence = permanence(&map);
        (walls > 0).then_some(Self { map, geometry, levels, permanence })
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
            levels.push(FieldLevel {
                geometry: self.geometry,
                part: FieldPart::whole(&self.geometry),
                values,
                shift,
            });
        }
        levels
    }

    /// First cells of the blocks of the field, so many cells along their sides, in which the map has free floor.
    pub(super) fn free_blocks(&self, side: i32) -> Vec<[i32; 2]> {
        let mut starts = Vec::new();
        let (columns, rows) = (self.geometry.columns() as i32, self.geometry.rows() as i32);
        let origin = self.geometry.origin_in_map();
        let edge_m = f64::from(self.geometry.resolution_m());
        let cell_of = |column: i32, row: i32| {
            let at = |cell: i32, origin: f32| f64::from(origin) + (f64::from(cell) + 0.5) * edge_m;
            self.map.cell_of([at(column, origin.x_m), at(row, origin.y_m)])
        };
        for row in (0..rows).step_by(side.max(1) as usize) {
            for column in (0..columns).step_by(side.max(1) as usize) {
                let mut cells = (row..row + side).flat_map(|y| (column..column + side).map(move |x| (x, y)));
                let is_free = cells.any(|(x, y)| {
                    let [x, y] = cell_of(x, y);
                    self.map.at(x, y) == Occupancy::Free
                });
                if is_free {
                    starts.push([column, row]);
                }
            }
        }
        starts
    }

    /// What became of a beam from a pose of the map to a return. A beam that grazes a wall crosses its cells before it ends
    /// on it: it went through only once it comes away from all walls behind the one it crossed.
    pub(super) fn fate(&self, pose: Se2, point: Point2) -> BeamFate {
        let [x_m, y_m] = pose.transform(point);
        let length_m = pose.distance(Se2::new(x_m, y_m, 0.0));
        let steps = (length_m / self.map.cell_m).floor();
        let step = self.map.cell_m / length_m.max(self.map.cell_m);
        // The most permanent cell of what the beam is in, and of what it has left behind.
        let (mut inside, mut crossed): (Option<u8>, Option<u8>) = (None, None);
        for at in 1..=steps.min(STEPS_MOST) as u32 {
            let share = f64::from(at) * step;
            let place = [pose.x_m + share * (x_m - pose.x_m), pose.y_m + share * (y_m - pose.y_m)];
            let [column, row] = self.map.cell_of(place);
            if self.map.at(column, row) == Occupancy::Occupied {
                inside = inside.max(Some(self.permanence[row as usize * self.map.columns + column as usize]));
            } else if inside.is_some() && self.value(place) == 0 {
                crossed = crossed.max(inside.take());
            }
        }
        let value = self.value([x_m, y_m]);
        let [column, row] = self.map.cell_of([x_m, y_m]);
        BeamFate {
            ends_on_floor: self.map.at(column, row) == Occupancy::Free,
            crossed: crossed.map(|permanence| f32::from(permanence) / 255.0),
            end: if value >= NEAR_LEAST { f32::from(value) / 255.0 } else { 0.0 },
        }
    }

    /// Value of the field at a place, 0 beyond it.
    fn value(&self, place: [f64; 2]) -> u8 {
        let origin = self.geometry.origin_in_map();
        let edge_m = f64::from(self.geometry.resolution_m());
        let cell = |value: f64, origin: f32| ((value - f64::from(origin)) / edge_m).floor() as i32;
        let level = FieldLevel {
            geometry: self.geometry,
            part: FieldPart::whole(&self.geometry),
            values: &self.levels[0],
            shift: 0,
        };
        level.at(cell(place[0], origin.x_m), cell(place[1], origin.y_m))
    }
}
