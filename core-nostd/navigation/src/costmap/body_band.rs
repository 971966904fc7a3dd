//! Returns in space, where they concern the robot's body: between the floor and its top.

use floorguard_mapping::Occupancy;
use floorguard_types::geometry::{Point2, Point3};

use super::obstacle_layer::{ObstacleLayer, ObstacleLimits};

/// Heights above the floor, metres.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BodyBand {
    /// Lower returns are floor.
    pub low_m: f32,
    /// Higher returns are above the robot.
    pub high_m: f32,
    /// A ray clears only where it passes below this height: higher ones see over low objects.
    pub clearing_below_m: f32,
}

/// A return of a sensor in space, in the axes of the map, z above the floor.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RayInSpace {
    /// Where the sensor was.
    pub from_in_map: Point3,
    /// Where the ray ended.
    pub to_in_map: Point3,
}

impl RayInSpace {
    /// The share of the ray, from 0 at the sensor to 1 at its end, that lies between two heights.
    fn between(&self, low_m: f32, high_m: f32) -> Option<[f32; 2]> {
        let (from_m, rise_m) = (self.from_in_map.z_m, self.to_in_map.z_m - self.from_in_map.z_m);
        if libm::fabsf(rise_m) < 1.0e-6 {
            return (low_m..=high_m).contains(&from_m).then_some([0.0, 1.0]);
        }
        let (a, b) = ((low_m - from_m) / rise_m, (high_m - from_m) / rise_m);
        let (first, last) = (a.min(b).max(0.0), a.max(b).min(1.0));
        (first < last).then_some([first, last])
    }

    fn on_floor(&self, share: f32) -> Point2 {
        Point2::new(
            self.from_in_map.x_m + share * (self.to_in_map.x_m - self.from_in_map.x_m),
            self.from_in_map.y_m + share * (self.to_in_map.y_m - self.from_in_map.y_m),
        )
    }
}

impl<S: AsRef<[Occupancy]> + AsMut<[Occupancy]>> ObstacleLayer<S> {
    /// One sweep: returns within the band mark, and rays clear where they pass low enough to have met what stands there.
    pub fn observe_in_space(
        &mut self,
        band: BodyBand,
        limits: ObstacleLimits,
        rays: impl Iterator<Item = RayInSpace> + Clone,
    ) {
        for ray in rays.clone() {
            if let Some([first, last]) = ray.between(band.low_m, band.clearing_below_m) {
                let sensor = ray.on_floor(0.0);
                let (begin, end) = (ray.on_floor(first), ray.on_floor(last));
                self.clear(begin, end, limits.clear_m - sensor.distance(begin));
            }
        }
        for ray in rays {
            let end = ray.on_floor(1.0);
            let is_in_band = ray.to_in_map.z_m >= band.low_m && ray.to_in_map.z_m <= band.high_m;
            if is_in_band && end.distance(ray.on_floor(0.0)) <= limits.mark_m {
                self.mark(end);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use floorguard_mapping::GridGeometry;
    use std::vec;

    const BAND: BodyBand = BodyBand { low_m: 0.05, high_m: 1.2, clearing_below_m: 0.3 };

    fn ray(to: (f32, f32)) -> RayInSpace {
        let from_in_map = Point3::new(0.05, 0.55, 0.8);
        RayInSpace { from_in_map, to_in_map: Point3::new(to.0, 0.55, to.1) }
    }

    #[test]
    fn low_rays_clear_and_the_band_marks() {
        let geometry = GridGeometry::new(50, 11, 0.1, Point2::default()).unwrap();
        let mut layer = ObstacleLayer::new(geometry, vec![Occupancy::Free; 550]).unwrap();
        let limits = ObstacleLimits { mark_m: 10.0, clear_m: 10.0 };
        let at = |layer: &ObstacleLayer<vec::Vec<Occupancy>>, x_m| {
            layer.cells().values()[geometry.cell_at(Point2::new(x_m, 0.55)).unwrap()]
        };
        // A box at 2 m; a beam over it to the wall; one to the floor; one to the ceiling.
        let rays = [ray((2.05, 0.2)), ray((4.55, 0.75)), ray((1.05, 0.0)), ray((3.05, 2.0))];
        layer.observe_in_space(BAND, limits, rays.into_iter());
        assert_eq!(at(&layer, 2.05), Occupancy::Occupied);
        assert_eq!(at(&layer, 4.55), Occupancy::Occupied);
        assert_eq!(at(&layer, 3.05), Occupancy::Unknown, "the ceiling is above the robot");
        assert_eq!(at(&layer, 0.85), Occupancy::Free, "the beam to the floor passed here at 0.16 m");
        assert_eq!(at(&layer, 0.35), Occupancy::Unknown, "it passed here at 0.56 m");
        // The beam over the box alone does not clear it.
        layer.observe_in_space(BAND, limits, [ray((4.55, 0.75))].into_iter());
        assert_eq!(at(&layer, 2.05), Occupancy::Occupied);
    }
}
