//! What the sensors have seen: marked where rays end, cleared where they pass.
//!
//! All rays of a scan clear first, then all ends mark: a cell that one beam hits is not cleared by the next one that grazes
//! it. A beam that says nothing changes nothing.

use floorguard_mapping::{Grid, GridGeometry, GridTooSmall, Occupancy};
use floorguard_types::geometry::Point2;

use super::rays::RayCells;

/// A beam in the map frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Beam {
    /// Something stands here.
    Hit(Point2),
    /// The device says that there is nothing up to here.
    Free(Point2),
    /// It says nothing.
    Unknown,
}

/// How far rays count.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ObstacleLimits {
    /// Ends beyond this distance do not mark, metres.
    pub mark_m: f32,
    /// Rays clear up to this distance, metres.
    pub clear_m: f32,
}

impl ObstacleLimits {
    /// As shipped with ROS navigation: obstacles to 2.5 m, rays to 3.0 m.
    pub const PUBLISHED: Self = Self { mark_m: 2.5, clear_m: 3.0 };
}

/// A grid of what was seen.
#[derive(Clone, Debug)]
pub struct ObstacleLayer<S> {
    cells: Grid<Occupancy, S>,
}

impl<S: AsRef<[Occupancy]> + AsMut<[Occupancy]>> ObstacleLayer<S> {
    /// A layer on which nothing was seen yet, whatever the storage held.
    ///
    /// # Errors
    /// The storage is smaller than the raster.
    pub fn new(geometry: GridGeometry, storage: S) -> Result<Self, GridTooSmall> {
        let mut cells = Grid::new(geometry, storage)?;
        cells.values_mut().fill(Occupancy::Unknown);
        Ok(Self { cells })
    }

    /// What was seen, by cell.
    #[must_use]
    pub const fn cells(&self) -> &Grid<Occupancy, S> {
        &self.cells
    }

    /// Moves the window with the robot.
    pub fn recentre(&mut self, centre_in_map: Point2) {
        self.cells.recentre(centre_in_map, Occupancy::Unknown);
    }

    /// Forgets what was seen within a distance of a point: for recovery, where the layer holds what is no longer there.
    pub fn forget_within(&mut self, centre_in_map: Point2, radius_m: f32) {
        let geometry = *self.cells.geometry();
        for (index, cell) in self.cells.values_mut().iter_mut().enumerate() {
            if geometry.centre(index).distance(centre_in_map) <= radius_m {
                *cell = Occupancy::Unknown;
            }
        }
    }

    /// One scan from a sensor in the map frame.
    pub fn observe(
        &mut self,
        sensor_in_map: Point2,
        limits: ObstacleLimits,
        beams: impl Iterator<Item = Beam> + Clone,
    ) {
        for beam in beams.clone() {
            match beam {
                Beam::Hit(end) => self.clear(sensor_in_map, end, limits.clear_m),
                Beam::Free(end) => self.clear(sensor_in_map, end, limits.clear_m),
                Beam::Unknown => {}
            }
        }
        for beam in beams {
            if let Beam::Hit(end) = beam
                && end.distance(sensor_in_map) <= limits.mark_m
            {
                self.mark(end);
            }
        }
    }

    /// A place of which nothing is known is taken for free floor: one on which the robot itself stands. What was seen stays.
    pub fn suppose_free(&mut self, place_in_map: Point2) {
        let cell = self.cells.geometry().cell_at(place_in_map);
        let value = cell.and_then(|cell| self.cells.get_mut(cell));
        if let Some(value) = value.filter(|value| **value == Occupancy::Unknown) {
            *value = Occupancy::Free;
        }
    }

    /// Clears along a ray up to its end or to `reach_m`.
    fn clear(&mut self, from_in_map: Point2, to_in_map: Point2, reach_m: f32) {
        let length_m = from_in_map.distance(to_in_map);
        let share = if length_m > reach_m { reach_m / length_m } else { 1.0 };
        let end = Point2::new(
            from_in_map.x_m + share * (to_in_map.x_m - from_in_map.x_m),
            from_in_map.y_m + share * (to_in_map.y_m - from_in_map.y_m),
        );
        let geometry = *self.cells.geometry();
        for cell in RayCells::new(&geometry, from_in_map, end) {
            if let Some(value) = self.cells.get_mut(cell) {
                *value = Occupancy::Free;
            }
        }
    }

    /// Marks the cell of a point.
    fn mark(&mut self, end_in_map: Point2) {
        let cell = self.cells.geometry().cell_at(end_in_map);
        if let Some(value) = cell.and_then(|cell| self.cells.get_mut(cell)) {
            *value = Occupancy::Occupied;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::vec;

    fn layer() -> ObstacleLayer<vec::Vec<Occupancy>> {
        let geometry = GridGeometry::new(40, 20, 0.1, Point2::default()).unwrap();
        ObstacleLayer::new(geometry, vec![Occupancy::Free; 800]).unwrap()
    }

    fn at(layer: &ObstacleLayer<vec::Vec<Occupancy>>, x_m: f32, y_m: f32) -> Occupancy {
        layer.cells().values()[layer.cells().geometry().cell_at(Point2::new(x_m, y_m)).unwrap()]
    }

    #[test]
    fn rays_mark_ends_and_clear_the_path() {
        let mut layer = layer();
        let sensor = Point2::new(0.55, 1.05);
        let limits = ObstacleLimits { mark_m: 2.0, clear_m: 2.5 };
        assert_eq!(at(&layer, 1.0, 1.05), Occupancy::Unknown);
        let wall = [Beam::Hit(Point2::new(2.05, 1.05)), Beam::Unknown, Beam::Hit(Point2::new(3.55, 0.55))];
        layer.observe(sensor, limits, wall.into_iter());
        assert_eq!(at(&layer, 2.05, 1.05), Occupancy::Occupied);
        assert_eq!(at(&layer, 1.05, 1.05), Occupancy::Free);
        assert_eq!(at(&layer, 2.25, 1.05), Occupancy::Unknown, "behind the hit");
        assert_eq!(at(&layer, 3.55, 0.55), Occupancy::Unknown, "beyond the limit");
        layer.observe(sensor, limits, [Beam::Free(Point2::new(3.85, 1.05))].into_iter());
        assert_eq!(at(&layer, 2.05, 1.05), Occupancy::Free, "it went away");
        assert_eq!(at(&layer, 3.45, 1.05), Occupancy::Unknown, "rays clear to 2.5 m");
    }

    #[test]
    fn neighbour_beam_does_not_clear_a_hit() {
        let mut layer = layer();
        let sensor = Point2::new(0.55, 1.05);
        let beams = [Beam::Hit(Point2::new(2.05, 1.05)), Beam::Hit(Point2::new(2.65, 1.07))];
        layer.observe(sensor, ObstacleLimits::PUBLISHED, beams.into_iter());
        assert_eq!(at(&layer, 2.05, 1.05), Occupancy::Occupied);
        layer.suppose_free(Point2::new(2.05, 1.05));
        assert_eq!(at(&layer, 2.05, 1.05), Occupancy::Occupied, "what was seen stays");
        layer.forget_within(Point2::new(2.05, 1.05), 0.2);
        assert_eq!(at(&layer, 2.05, 1.05), Occupancy::Unknown);
        layer.suppose_free(Point2::new(2.05, 1.05));
        assert_eq!(at(&layer, 2.05, 1.05), Occupancy::Free);
        assert_eq!(at(&layer, 2.65, 1.05), Occupancy::Occupied);
    }
}
