//! The returns of the last metres.

use floorguard_mapping::match_field::{FieldPart, MatchField};
use floorguard_mapping::{GridCoordinates, GridGeometry, GridSides};
use floorguard_types::geometry::Point2;

use super::config::FrontEndConfig;
use crate::pages::Pages;
use crate::se2::Se2;

/// A field of returns around the place where it began. It could hold all that the scanner can see from there; of that, the part
/// that was seen is stored.
pub struct LocalMap {
    /// Its frame in the frame of the tracking.
    pub origin: Se2,
    /// Node with which it began.
    pub first_node: usize,
    /// Metres travelled since.
    pub travelled_m: f64,
    /// Scans written.
    pub scans: usize,
    geometry: GridGeometry,
    field: MatchField<Pages>,
}

/// What is stored begins and ends at multiples of this many cells: it is made again every few metres only.
const STORED_CELLS: i32 = 64;

/// From the first to the last cell.
fn part([first, last]: [GridCoordinates; 2]) -> FieldPart {
    let count = |first: i32, last: i32| u32::try_from(last - first + 1).unwrap_or(0);
    let sides = GridSides { columns: count(first.column, last.column), rows: count(first.row, last.row) };
    FieldPart { first, sides }
}

/// First and last cell of what holds both.
fn united([a, b]: [GridCoordinates; 2], [c, d]: [GridCoordinates; 2]) -> [GridCoordinates; 2] {
    let cell = |one: GridCoordinates, other: GridCoordinates, choose: fn(i32, i32) -> i32| GridCoordinates {
        column: choose(one.column, other.column),
        row: choose(one.row, other.row),
    };
    [cell(a, c, i32::min), cell(b, d, i32::max)]
}

impl LocalMap {
    /// An empty map. `None` if the settings give no raster.
    #[must_use]
    pub fn new(origin: Se2, first_node: usize, config: &FrontEndConfig) -> Option<Self> {
        let half = config.half_side_m;
        let side = (2.0 * half / config.cell_m) as u16;
        let geometry = GridGeometry::new(side, side, config.cell_m, Point2::new(-half, -half))?;
        let middle = GridCoordinates { column: i32::from(side / 2), row: i32::from(side / 2) };
        let part = part([middle, middle]);
        let field =
            MatchField::within(geometry, part, [Pages::new(1), Pages::new(1)], config.descent.reach_m).ok();
        Some(Self { origin, first_node, travelled_m: 0.0, scans: 0, geometry, field: field? })
    }

    /// Writes the returns of a scan taken at a pose of the tracking's frame.
    pub fn insert(&mut self, pose: Se2, points: &[Point2]) {
        let pose_in_map = self.origin.between(pose).single();
        self.make_room(points.iter().map(|point| pose_in_map.transform(*point)));
        for point in points {
            self.field.insert(pose_in_map.transform(*point));
        }
        self.scans += 1;
    }

    /// Stores the cells that returns in the map's frame reach, too.
    fn make_room(&mut self, points: impl Iterator<Item = Point2>) {
        let Some(reached) = points.filter_map(|point| self.field.reached_by(point)).reduce(united) else {
            return;
        };
        let FieldPart { first, sides } = self.field.part();
        let last = |first: i32, count: u32| first + count as i32 - 1;
        let last =
            GridCoordinates { column: last(first.column, sides.columns), row: last(first.row, sides.rows) };
        let [low, high] = united([first, last], reached);
        if [low, high] == [first, last] {
            return;
        }
        let begins = |low: i32| low - low.rem_euclid(STORED_CELLS);
        let ends = |high: i32, side: usize| (begins(high) + STORED_CELLS).min(side as i32) - 1;
        let (columns, rows) = (self.geometry.columns(), self.geometry.rows());
        let low = GridCoordinates { column: begins(low.column), row: begins(low.row) };
        let high = GridCoordinates { column: ends(high.column, columns), row: ends(high.row, rows) };
        // The storage is always as large as it is asked for.
        let _ = self.field.store(part([low, high]), Pages::new);
    }

    /// The field.
    #[must_use]
    pub const fn field(&self) -> &MatchField<Pages> {
        &self.field
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// What is stored piece by piece answers as what is stored as a whole.
    #[test]
    fn stored_part_answers_like_whole_field() {
        let config = FrontEndConfig::default();
        let mut map = LocalMap::new(Se2::default(), 0, &config).unwrap();
        let whole = FieldPart::whole(&map.geometry);
        let cells = whole.cell_count();
        let mut expected =
            MatchField::new(map.geometry, [Pages::new(cells), Pages::new(cells)], config.descent.reach_m)
                .unwrap();
        let place = |k: i32, side: i32| 0.37 * ((k * side) % 113 - 30) as f32;
        for scan in 0..6 {
            let points: Vec<Point2> =
                (scan * 20..scan * 20 + 20).map(|k| Point2::new(place(k, 17), place(k, 29) * 1.3)).collect();
            map.insert(Se2::default(), &points);
            points.iter().for_each(|point| expected.insert(*point));
        }
        map.insert(Se2::default(), &[Point2::new(-41.99, 41.99), Point2::new(f32::NAN, 0.0)]);
        expected.insert(Point2::new(-41.99, 41.99));
        assert!(
            map.field.part() != whole && map.field.part().cell_count() > 10_000,
            "{:?}",
            map.field.part()
        );
        for (part, whole) in map.field.levels().iter().zip(expected.levels()) {
            for row in -5..1_690 {
                assert!((-5..1_690).all(|column| part.at(column, row) == whole.at(column, row)), "{row}");
            }
            for k in 0..40_000 {
                let point = Point2::new(
                    0.00211 * (k % 20_011) as f32 - 20.0,
                    0.0021 * (k * 7 % 40_000) as f32 - 42.0,
                );
                assert_eq!(part.sample(point), whole.sample(point), "{point:?}");
            }
        }
    }
}
