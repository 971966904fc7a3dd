//! What a lidar has seen of the body's height: marked where rays end, with the height, and cleared where a ray passes as high.
//!
//! Each cell keeps 32 bands of 5 cm. A flat layer would forget a table board as soon as a ray passes above it on its way to the
//! wall; here only a ray that passes at the height of a mark, or up to 20 cm below it, shows that the place is free.

use floorguard_mapping::{Grid, GridGeometry, GridTooSmall};
use floorguard_types::geometry::{Point2, Point3};
use floorguard_types::number::saturating_u32;

use super::rays::RayCells;

/// Height of a band, metres.
const BAND_M: f32 = 0.05;
/// Bands of a cell.
const BANDS: u32 = 32;
/// A passing ray clears its own band and so many above it: marks between two rings are seen by neither again.
const CLEARED_ABOVE: u32 = 4;

/// A ray of a lidar in the axes of the map, z above the floor.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SpaceRay {
    /// Where the sensor was.
    pub from_in_map: Point3,
    /// Where the ray ended.
    pub to_in_map: Point3,
    /// Its end marks. The end on somebody who walks does not: planners get them with their velocity.
    pub marks: bool,
}

/// What counts.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SpaceLimits {
    /// Lower ends are floor, metres.
    pub low_m: f32,
    /// Higher ends are above the robot, metres; at most 1.6.
    pub high_m: f32,
    /// Ends beyond this horizontal distance do not mark, metres. Rays clear one metre farther.
    pub mark_m: f32,
    /// A mark that was not seen again for so many sweeps is forgotten: near the robot no ray can clear it.
    pub kept_sweeps: u16,
}

/// The bands of a cell in which something was seen, lowest bit lowest, and the sweep in which it was last.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct SpaceCell {
    /// One bit a band.
    pub bands: u32,
    /// The number of the sweep, wrapping.
    pub sweep: u16,
}

/// A grid of what was seen above the floor.
#[derive(Clone, Debug)]
pub struct SpaceLayer<S> {
    cells: Grid<SpaceCell, S>,
    sweep: u16,
}

impl<S: AsRef<[SpaceCell]> + AsMut<[SpaceCell]>> SpaceLayer<S> {
    /// A layer on which nothing was seen yet, whatever the storage held.
    ///
    /// # Errors
    /// The storage is smaller than the raster.
    pub fn new(geometry: GridGeometry, storage: S) -> Result<Self, GridTooSmall> {
        let mut cells = Grid::new(geometry, storage)?;
        cells.values_mut().fill(SpaceCell::default());
        Ok(Self { cells, sweep: 0 })
    }

    /// Something stands or hangs in this cell.
    #[must_use]
    pub fn is_marked(&self, cell: usize) -> bool {
        self.cells.get(cell).is_some_and(|cell| cell.bands != 0)
    }

    /// Forgets what was seen within a distance of a point: for recovery, where the layer holds what is no longer there.
    pub fn forget_within(&mut self, centre_in_map: Point2, radius_m: f32) {
        let geometry = *self.cells.geometry();
        for (index, cell) in self.cells.values_mut().iter_mut().enumerate() {
            if cell.bands != 0 && geometry.centre(index).distance(centre_in_map) <= radius_m {
                *cell = SpaceCell::default();
            }
        }
    }

    /// One sweep: all rays clear first, then all ends mark. Costs the cells that the rays pass.
    pub fn observe(&mut self, limits: &SpaceLimits, rays: impl Iterator<Item = SpaceRay> + Clone) {
        self.sweep = self.sweep.wrapping_add(1);
        for ray in rays.clone() {
            self.clear(limits, &ray);
        }
        for ray in rays {
            let SpaceRay { from_in_map: from, to_in_map: end, marks } = ray;
            let is_near = floor_of(end).distance(floor_of(from)) <= limits.mark_m;
            if marks && is_near && end.z_m >= limits.low_m && end.z_m <= limits.high_m {
                self.mark(end);
            }
        }
        let (sweep, kept) = (self.sweep, limits.kept_sweeps);
        for cell in self.cells.values_mut() {
            if cell.bands != 0 && sweep.wrapping_sub(cell.sweep) > kept {
                cell.bands = 0;
            }
        }
    }

    /// Clears along a ray, but for the last cells before its end.
    fn clear(&mut self, limits: &SpaceLimits, ray: &SpaceRay) {
        let (from, end) = (floor_of(ray.from_in_map), floor_of(ray.to_in_map));
        let length_m = from.distance(end);
        let geometry = *self.cells.geometry();
        let passed_m = (length_m - 2.0 * geometry.resolution_m()).min(limits.mark_m + 1.0);
        if !(length_m.is_finite() && passed_m > 0.0) {
            return;
        }
        let per_metre = 1.0 / length_m;
        let rise = (ray.to_in_map.z_m - ray.from_in_map.z_m) * per_metre;
        let share = passed_m * per_metre;
        let last =
            Point2::new(from.x_m + share * (end.x_m - from.x_m), from.y_m + share * (end.y_m - from.y_m));
        for cell in RayCells::new(&geometry, from, last) {
            let Some(value) = self.cells.get_mut(cell).filter(|value| value.bands != 0) else { continue };
            let along_m = geometry.centre(cell).distance(from);
            value.bands &= !cleared_by(ray.from_in_map.z_m + rise * along_m);
        }
    }

    fn mark(&mut self, end: Point3) {
        let sweep = self.sweep;
        let cell = self.cells.geometry().cell_at(floor_of(end));
        let Some(value) = cell.and_then(|cell| self.cells.get_mut(cell)) else { return };
        let Some(band) = band_of(end.z_m) else { return };
        *value = SpaceCell { bands: value.bands | 1_u32.wrapping_shl(band), sweep };
    }
}

const fn floor_of(place: Point3) -> Point2 {
    Point2::new(place.x_m, place.y_m)
}

/// The band of a height; none below the floor and above the last one.
fn band_of(height_m: f32) -> Option<u32> {
    let is_above = height_m >= 0.0;
    let band = saturating_u32(height_m / BAND_M);
    (is_above && band < BANDS).then_some(band)
}

/// The bands that are free where a ray passes at this height.
fn cleared_by(height_m: f32) -> u32 {
    let Some(band) = band_of(height_m) else { return 0 };
    let run = 1_u32.wrapping_shl(CLEARED_ABOVE.wrapping_add(1)).wrapping_sub(1);
    run.wrapping_shl(band)
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::vec;
    use std::vec::Vec;

    const LIMITS: SpaceLimits = SpaceLimits { low_m: 0.1, high_m: 1.3, mark_m: 6.0, kept_sweeps: 3 };

    fn layer() -> SpaceLayer<Vec<SpaceCell>> {
        let geometry = GridGeometry::new(60, 11, 0.1, Point2::default()).unwrap();
        SpaceLayer::new(geometry, vec![SpaceCell { bands: 7, sweep: 0 }; 660]).unwrap()
    }

    fn marked(layer: &SpaceLayer<Vec<SpaceCell>>, x_m: f32) -> bool {
        layer.is_marked(layer.cells.geometry().cell_at(Point2::new(x_m, 0.55)).unwrap())
    }

    fn ray(to: (f32, f32)) -> SpaceRay {
        SpaceRay {
            from_in_map: Point3::new(0.05, 0.55, 1.0),
            to_in_map: Point3::new(to.0, 0.55, to.1),
            marks: true,
        }
    }

    #[test]
    fn board_stays_under_rays_above_it() {
        let mut layer = layer();
        assert!(!marked(&layer, 2.05), "the storage's past does not count");
        layer.observe(&LIMITS, [ray((2.05, 0.7)), ray((5.05, 0.0)), ray((3.05, 1.9))].into_iter());
        assert!(marked(&layer, 2.05) && !marked(&layer, 5.05) && !marked(&layer, 3.05));
        // Seen from above: 0.8 m high where the board is.
        layer.observe(&LIMITS, [ray((5.05, 0.5))].into_iter());
        assert!(marked(&layer, 2.05));
        // It has gone: a ray passes 0.6 m high.
        layer.observe(&LIMITS, [ray((5.05, 0.0))].into_iter());
        assert!(!marked(&layer, 2.05));
    }

    #[test]
    fn walkers_do_not_mark_and_old_marks_fade() {
        let mut layer = layer();
        layer.observe(&LIMITS, [SpaceRay { marks: false, ..ray((2.05, 0.7)) }].into_iter());
        assert!(!marked(&layer, 2.05));
        layer.observe(&LIMITS, [ray((2.05, 0.7))].into_iter());
        for sweeps in 1..=4 {
            layer.observe(&LIMITS, core::iter::empty());
            assert_eq!(marked(&layer, 2.05), sweeps <= 3, "after {sweeps} sweeps");
        }
        layer.observe(&LIMITS, [ray((2.05, 0.7)), ray((f32::NAN, 0.5))].into_iter());
        layer.forget_within(Point2::new(2.0, 0.5), 0.3);
        assert!(!marked(&layer, 2.05));
    }
}
