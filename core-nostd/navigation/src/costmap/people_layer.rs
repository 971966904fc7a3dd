//! People in the costmap: a hill of cost around each, longer in the direction in which they walk (Kirby 2010, section 4.2:
//! an asymmetric Gaussian). The floor ahead of somebody is worth more than the floor behind.

use floorguard_mapping::{GRID_SIDE_MAX, GridCoordinates, GridGeometry};
use floorguard_types::geometry::Point2;
use floorguard_types::motion::MovingPerson;
use floorguard_types::number::saturating_u8;

use super::view::Costs;

/// Shape of the hill.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PeopleCost {
    /// Within this distance of the middle the cost is that of a collision, metres: body and inscribed radius of the robot.
    pub collision_radius_m: f32,
    /// Deviation to the sides and behind, metres, > 0.
    pub deviation_m: f32,
    /// Additional deviation ahead for every m/s, metres.
    pub ahead_m_per_mps: f32,
    /// Highest cost outside of the collision radius, at most 252.
    pub peak: u8,
}

impl PeopleCost {
    /// Half a metre to the sides; a second of walking ahead.
    pub const DEFAULT: Self =
        Self { collision_radius_m: 0.5, deviation_m: 0.45, ahead_m_per_mps: 1.0, peak: 220 };

    fn reach_m(&self, person: &MovingPerson) -> f32 {
        let speed_mps = person.velocity_in_map_mps.norm();
        3.0 * (self.deviation_m + self.ahead_m_per_mps * speed_mps + person.position_deviation_m)
            + self.collision_radius_m
    }

    /// Cost of a place beside a person.
    fn at(&self, person: &MovingPerson, place_in_map: Point2) -> u8 {
        let (dx_m, dy_m) =
            (place_in_map.x_m - person.position_in_map.x_m, place_in_map.y_m - person.position_in_map.y_m);
        let distance_m = Point2::new(dx_m, dy_m).norm();
        if distance_m <= self.collision_radius_m && person.position_deviation_m <= self.collision_radius_m {
            return Costs::INSCRIBED;
        }
        let speed_mps = person.velocity_in_map_mps.norm();
        let spread_m = Point2::new(self.deviation_m, person.position_deviation_m).norm();
        let (along_m, aside_m) = if speed_mps > 0.1 {
            let (ux, uy) =
                (person.velocity_in_map_mps.x_m / speed_mps, person.velocity_in_map_mps.y_m / speed_mps);
            (dx_m * ux + dy_m * uy, dy_m * ux - dx_m * uy)
        } else {
            (distance_m, 0.0)
        };
        let is_ahead = along_m > 0.0 && speed_mps > 0.1;
        let along_deviation_m = if is_ahead { spread_m + self.ahead_m_per_mps * speed_mps } else { spread_m };
        let exponent = along_m * along_m / (2.0 * along_deviation_m * along_deviation_m)
            + aside_m * aside_m / (2.0 * spread_m * spread_m);
        saturating_u8(f32::from(self.peak.min(252)) * libm::expf(-exponent))
    }
}

/// Raises costs around people, present ones or expected ones (with their larger deviation). Known lower costs rise, nothing
/// falls, and unknown stays unknown. People whose numbers are not legal are left out and counted in the result.
pub fn add_people(
    geometry: &GridGeometry,
    costs: &mut [u8],
    people: &[MovingPerson],
    shape: &PeopleCost,
) -> usize {
    let mut refused = 0_usize;
    for person in people {
        if !person.is_legal() {
            refused = refused.saturating_add(1);
            continue;
        }
        let reach_m = shape.reach_m(person);
        let middle = person.position_in_map;
        let GridCoordinates { column: first_column, row: first_row } =
            geometry.coordinates_of(Point2::new(middle.x_m - reach_m, middle.y_m - reach_m));
        let GridCoordinates { column: last_column, row: last_row } =
            geometry.coordinates_of(Point2::new(middle.x_m + reach_m, middle.y_m + reach_m));
        let columns = i32::try_from(geometry.columns()).unwrap_or(i32::MAX);
        let rows = i32::try_from(geometry.rows()).unwrap_or(i32::MAX);
        for row in first_row.max(0)..last_row.saturating_add(1).min(rows).min(GRID_SIDE_MAX) {
            for column in first_column.max(0)..last_column.saturating_add(1).min(columns).min(GRID_SIDE_MAX) {
                let Some(cell) = geometry.index(column, row) else { continue };
                let Some(cost) = costs.get_mut(cell) else { continue };
                if *cost != Costs::UNKNOWN {
                    *cost = (*cost).max(shape.at(person, geometry.centre(cell)));
                }
            }
        }
    }
    refused
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::vec;

    #[test]
    fn ahead_of_a_walker_costs_more_than_behind() {
        let geometry = GridGeometry::new(100, 60, 0.1, Point2::default()).unwrap();
        let mut costs = vec![0; geometry.cell_count()];
        let cell = |x_m, y_m| geometry.cell_at(Point2::new(x_m, y_m)).unwrap();
        costs[cell(5.0, 3.0)] = Costs::UNKNOWN;
        let walker = MovingPerson {
            position_in_map: Point2::new(4.0, 3.0),
            velocity_in_map_mps: Point2::new(1.0, 0.0),
            position_deviation_m: 0.1,
            velocity_deviation_mps: 0.1,
        };
        let broken = MovingPerson { position_deviation_m: f32::NAN, ..walker };
        assert_eq!(add_people(&geometry, &mut costs, &[walker, broken], &PeopleCost::DEFAULT), 1);
        assert_eq!(costs[cell(4.0, 3.2)], Costs::INSCRIBED);
        assert!(costs[cell(5.2, 3.0)] > 150, "{}", costs[cell(5.2, 3.0)]);
        assert!(costs[cell(2.8, 3.0)] < 20);
        assert!(costs[cell(4.0, 4.2)] < 20);
        assert_eq!(costs[cell(5.0, 3.0)], Costs::UNKNOWN);
    }
}
