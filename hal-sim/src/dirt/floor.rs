//! Single specks at places of their own.
//!
//! A robot believes in units in cells; the truth counts specks, so that one judges the other. A speck that the brush
//! passes is picked up with a fixed probability, once a pass (book, Cleaning: Passes).

use floorguard_mapping::GridGeometry;
use floorguard_types::geometry::Point2;
use floorguard_types::random::Pcg32;

use crate::robot::BrushPass;

/// After this long without the brush, the next contact is a new pass, s (book, Cleaning: Passes).
const PASS_ENDS_S: f32 = 0.5;

#[derive(Clone, Debug)]
struct Speck {
    place: Point2,
    is_passed: bool,
    is_removed: bool,
}

/// The dirt of one cell, and when the brush last was there.
#[derive(Clone, Debug)]
struct DirtyCell {
    specks: Vec<Speck>,
    last_swept_s: f32,
}

/// All dirt of a floor. The raster only finds the specks quickly.
#[derive(Clone, Debug)]
pub struct DirtyFloor {
    raster: GridGeometry,
    cells: Vec<Option<Box<DirtyCell>>>,
}

impl DirtyFloor {
    /// Draws the specks of every cell of a raster: their number is Poisson with the expected units, their places are
    /// uniform within the cell.
    #[must_use]
    pub fn draw(raster: GridGeometry, expected_units: &[f32], random: &mut Pcg32) -> Self {
        let edge_m = raster.resolution_m();
        let mut cell = |(index, units): (usize, &f32)| {
            let count = random.poisson(*units);
            let centre = raster.centre(index);
            let mut speck = || {
                let x_m = centre.x_m + random.uniform_between(-0.5, 0.5) * edge_m;
                let y_m = centre.y_m + random.uniform_between(-0.5, 0.5) * edge_m;
                Speck { place: Point2::new(x_m, y_m), is_passed: false, is_removed: false }
            };
            let specks: Vec<Speck> = (0..count).map(|_| speck()).collect();
            (!specks.is_empty()).then(|| Box::new(DirtyCell { specks, last_swept_s: -1.0 }))
        };
        let cells = expected_units.iter().take(raster.cell_count()).enumerate().map(&mut cell).collect();
        Self { raster, cells }
    }

    /// The brush sweeps the ground at `now_s`, seconds since the start. Gives the units that it picked up; each speck that
    /// it meets is picked up with probability `pickup`.
    pub fn sweep(&mut self, pass: &BrushPass, now_s: f32, (pickup, random): (f32, &mut Pcg32)) -> u32 {
        let [first, last] = pass.bounds().map(|corner| self.raster.coordinates_of(corner));
        let mut units = 0;
        for row in first.row..=last.row {
            for column in first.column..=last.column {
                let Some(cell) = self.raster.index(column, row) else { continue };
                let Some(Some(dirty)) = self.cells.get_mut(cell) else { continue };
                units += sweep_cell(dirty, pass, now_s, (pickup, random));
            }
        }
        units
    }

    /// A speck lies within a radius of a place, metres; at most half a cell.
    #[must_use]
    pub fn is_speck_within(&self, place: Point2, radius_m: f32) -> bool {
        let corner = |sign: f32| Point2::new(place.x_m + sign * radius_m, place.y_m + sign * radius_m);
        let (first, last) =
            (self.raster.coordinates_of(corner(-1.0)), self.raster.coordinates_of(corner(1.0)));
        let cells = (first.row..=last.row)
            .flat_map(|row| (first.column..=last.column).map(move |column| (column, row)));
        cells
            .filter_map(|(column, row)| self.cells.get(self.raster.index(column, row)?)?.as_deref())
            .flat_map(|dirty| &dirty.specks)
            .any(|speck| !speck.is_removed && speck.place.distance(place) <= radius_m)
    }

    /// Units that really lie in a cell of the raster.
    #[must_use]
    pub fn units(&self, cell: usize) -> u32 {
        let left = |dirty: &DirtyCell| dirty.specks.iter().filter(|speck| !speck.is_removed).count() as u32;
        self.cells.get(cell).and_then(Option::as_deref).map_or(0, left)
    }

    /// Units that really lie in each cell of any other raster.
    #[must_use]
    pub fn units_on(&self, raster: &GridGeometry) -> Vec<u32> {
        let mut units = vec![0; raster.cell_count()];
        for speck in self.cells.iter().flatten().flat_map(|dirty| &dirty.specks) {
            if let Some(cell) = raster.cell_at(speck.place).filter(|_| !speck.is_removed) {
                units[cell] += 1;
            }
        }
        units
    }
}

fn sweep_cell(
    dirty: &mut DirtyCell,
    pass: &BrushPass,
    now_s: f32,
    (pickup, random): (f32, &mut Pcg32),
) -> u32 {
    let is_new_pass = now_s - dirty.last_swept_s > PASS_ENDS_S;
    dirty.last_swept_s = now_s;
    let mut removed = 0;
    for speck in &mut dirty.specks {
        if is_new_pass {
            speck.is_passed = false;
        }
        if speck.is_removed || speck.is_passed || !pass.covers(speck.place) {
            continue;
        }
        speck.is_passed = true;
        speck.is_removed = random.bernoulli(pickup);
        removed += u32::from(speck.is_removed);
    }
    removed
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::robot::BrushDeck;
    use floorguard_types::geometry::Pose2;

    /// A bar of 0.2 m that rolls over three rows of cells of 0.1 m, of which only the inner two lie under it.
    #[test]
    fn pass_takes_its_share_under_the_brush() {
        let raster = GridGeometry::new(100, 3, 0.1, Point2::new(0.0, -0.1)).unwrap();
        let mut random = Pcg32::new(5, 0);
        let mut floor = DirtyFloor::draw(raster, &[20.0; 300], &mut random);
        let row = |floor: &DirtyFloor, row: usize| (0..100).map(|c| floor.units(row * 100 + c)).sum::<u32>();
        let before = [0, 1, 2].map(|index| row(&floor, index));
        assert!(before.iter().all(|units| (1_800..2_200).contains(units)), "{before:?}");
        let brush = BrushDeck { width_m: 0.2, offset_m: 0.0 };
        let mut taken = 0;
        for step in 0..1_100 {
            let from_m = step as f32 * 0.01 - 0.5;
            let pass = brush.pass(Pose2::new(from_m, 0.0, 0.0), Pose2::new(from_m + 0.01, 0.0, 0.0));
            taken += floor.sweep(&pass, step as f32 * 0.01, (0.9, &mut random));
        }
        let after = [0, 1, 2].map(|index| row(&floor, index));
        assert_eq!(after[2], before[2]);
        assert_eq!(taken, before[0] + before[1] - after[0] - after[1]);
        let share = taken as f32 / (before[0] + before[1]) as f32;
        assert!((share - 0.9).abs() < 0.02, "{share}");
        let coarse = GridGeometry::new(10, 1, 1.0, Point2::new(0.0, -0.5)).unwrap();
        assert_eq!(floor.units_on(&coarse).iter().sum::<u32>(), after.iter().sum::<u32>());
    }
}
