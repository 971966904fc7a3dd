//! The dirt of a scenario file: how much is expected where.

use floorguard_mapping::GridGeometry;
use floorguard_types::geometry::Point2;
use floorguard_types::random::Pcg32;
use serde::{Deserialize, Serialize};

/// Edge of a patch of dirt, metres: a cell of the cleaning belief (book, Cleaning: Dirt model).
const PATCH_M: f32 = 0.1;

/// A round spill.
#[derive(Clone, Copy, Debug, Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
pub struct SpillFile {
    /// Middle, world frame, metres.
    pub at_m: [f32; 2],
    /// Metres.
    pub radius_m: f32,
    /// Expected units on 0.1 × 0.1 m.
    pub units: f32,
}

/// Dirt on the floor. One unit is one hit of the dirt sensor.
#[derive(Clone, Debug, Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
pub struct DirtFile {
    /// Share of dirt under the brush that one pass picks up.
    #[serde(default = "pickup")]
    pub pickup: f32,
    /// Spills.
    #[serde(default)]
    pub spill: Vec<SpillFile>,
    /// Where patches are strewn at random: from the lower left to the upper right corner, world frame, metres.
    #[serde(default)]
    pub strewn_area_m: Option<[f32; 4]>,
    /// Share of that area with patches.
    #[serde(default)]
    pub strewn_share: f32,
    /// Expected units of a patch: from, to.
    #[serde(default)]
    pub strewn_units: [f32; 2],
}

const fn pickup() -> f32 {
    0.9
}

/// A square of dirt, 0.1 m a side, aligned with the world's axes at multiples of 0.1 m.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DirtyPatch {
    /// Column and row: the square begins at a tenth of these, metres.
    pub place: (i32, i32),
    /// Expected units.
    pub units: f32,
}

impl DirtyPatch {
    /// Edge, metres.
    pub const EDGE_M: f32 = PATCH_M;

    /// Lower left corner, world frame.
    #[must_use]
    pub fn corner(&self) -> Point2 {
        Point2::new(self.place.0 as f32 * PATCH_M, self.place.1 as f32 * PATCH_M)
    }
}

impl DirtFile {
    /// Every patch, in the order of row and column. Where two overlap the larger expectation counts. `is_floor` tells where
    /// dirt can lie.
    #[must_use]
    pub fn patches(&self, seed: u64, is_floor: impl Fn(Point2) -> bool) -> Vec<DirtyPatch> {
        let mut found = std::collections::BTreeMap::new();
        for spill in &self.spill {
            let [x_m, y_m] = spill.at_m;
            for place in places([
                x_m - spill.radius_m,
                y_m - spill.radius_m,
                x_m + spill.radius_m,
                y_m + spill.radius_m,
            ]) {
                if middle(place).distance(Point2::new(x_m, y_m)) <= spill.radius_m {
                    raise(&mut found, place, spill.units);
                }
            }
        }
        let mut random = Pcg32::new(seed, 62);
        for place in self.strewn_area_m.into_iter().flat_map(places) {
            // Two draws a place, whatever lies there: what one place holds does not depend on the others.
            let (drawn, units) =
                (random.uniform(), random.uniform_between(self.strewn_units[0], self.strewn_units[1]));
            if drawn < self.strewn_share {
                raise(&mut found, place, units);
            }
        }
        found.retain(|place, units| *units > 0.0 && is_floor(middle(*place)));
        found.into_iter().map(|((column, row), units)| DirtyPatch { place: (column, row), units }).collect()
    }
}

/// The raster around patches, and what is expected in each of its cells; nothing without patches.
pub(crate) fn raster_of(patches: &[DirtyPatch]) -> Option<(GridGeometry, Vec<f32>)> {
    let columns = || patches.iter().map(|patch| patch.place.0);
    let rows = || patches.iter().map(|patch| patch.place.1);
    let (first_column, first_row) = (columns().min()?, rows().min()?);
    let width = u16::try_from(columns().max()? - first_column + 1).ok()?;
    let height = u16::try_from(rows().max()? - first_row + 1).ok()?;
    let corner = DirtyPatch { place: (first_column, first_row), units: 0.0 }.corner();
    let raster = GridGeometry::new(width, height, PATCH_M, corner)?;
    let mut expected = vec![0.0; raster.cell_count()];
    for patch in patches {
        let cell = raster.index(patch.place.0 - first_column, patch.place.1 - first_row)?;
        *expected.get_mut(cell)? = patch.units;
    }
    Some((raster, expected))
}

fn middle((column, row): (i32, i32)) -> Point2 {
    Point2::new((column as f32 + 0.5) * PATCH_M, (row as f32 + 0.5) * PATCH_M)
}

/// All places of a rectangle, row by row.
fn places([x0, y0, x1, y1]: [f32; 4]) -> impl Iterator<Item = (i32, i32)> {
    let index = |value_m: f32| (value_m / PATCH_M).floor() as i32;
    let (columns, rows) = (index(x0)..=index(x1), index(y0)..=index(y1));
    rows.flat_map(move |row| columns.clone().map(move |column| (column, row)))
}

fn raise(found: &mut std::collections::BTreeMap<(i32, i32), f32>, place: (i32, i32), units: f32) {
    let known = found.entry(place).or_default();
    *known = known.max(units);
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn spills_are_round_patches_strewn() {
        let text = "spill = [{ at_m = [1.0, 2.0], radius_m = 0.3, units = 12.0 }]\n\
                    strewn_area_m = [4.0, 0.0, 8.0, 5.0]\nstrewn_share = 0.1\nstrewn_units = [5.0, 10.0]";
        let file: DirtFile = toml::from_str(text).unwrap();
        let patches = file.patches(1, |_| true);
        let spill = patches.iter().filter(|patch| patch.units == 12.0).count() as f32;
        assert!((spill * 0.01 - core::f32::consts::PI * 0.09).abs() < 0.05, "{spill}");
        let strewn = patches.len() as f32 - spill;
        assert!((strewn / 2_000.0 - 0.1).abs() < 0.02, "{strewn}");
        assert_eq!(patches, file.patches(1, |_| true));
        assert!(file.patches(1, |place| place.x_m > 3.0).iter().all(|patch| patch.units != 12.0));
        let (raster, expected) = raster_of(&patches).unwrap();
        assert_eq!(expected.iter().filter(|units| **units > 0.0).count(), patches.len());
        assert_eq!(raster.cell_at(Point2::new(1.0, 2.0)).map(|cell| expected[cell]), Some(12.0));
        assert!(raster_of(&[]).is_none());
    }
}
