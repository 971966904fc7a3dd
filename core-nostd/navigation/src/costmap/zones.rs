//! Zones drawn by people: where the robot must not drive, and where only slowly.

use floorguard_mapping::{GRID_SIDE_MAX, GridCoordinates, GridGeometry};
use floorguard_types::capacities::FIELD_VERTICES_MAX;
use floorguard_types::geometry::Point2;
use heapless::Vec;

use super::view::Costs;

/// What holds in a zone.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum ZoneKind {
    /// The robot's body stays out.
    NoGo,
    /// It drives at most this fast, m/s.
    SpeedLimit(f32),
}

/// A polygon of the map with a rule.
#[derive(Clone, Debug, PartialEq)]
pub struct Zone {
    /// Corners in order, in the map frame.
    pub corners_in_map: Vec<Point2, FIELD_VERTICES_MAX>,
    /// The rule.
    pub kind: ZoneKind,
}

impl Zone {
    /// A point of the map frame lies inside. Crossing number, half open at the edges.
    #[must_use]
    pub fn contains(&self, point_in_map: Point2) -> bool {
        let next = self.corners_in_map.iter().cycle().skip(1);
        let mut inside = false;
        for (a, b) in self.corners_in_map.iter().zip(next) {
            if (a.y_m > point_in_map.y_m) != (b.y_m > point_in_map.y_m) {
                let t = (point_in_map.y_m - a.y_m) / (b.y_m - a.y_m);
                inside ^= point_in_map.x_m < a.x_m + t * (b.x_m - a.x_m);
            }
        }
        inside
    }

    /// Makes every cell whose centre lies inside an obstacle; only for [`ZoneKind::NoGo`].
    pub(super) fn forbid(&self, geometry: &GridGeometry, costs: &mut [u8]) {
        if self.kind != ZoneKind::NoGo {
            return;
        }
        let mut low = Point2::new(f32::INFINITY, f32::INFINITY);
        let mut high = Point2::new(f32::NEG_INFINITY, f32::NEG_INFINITY);
        for corner in &self.corners_in_map {
            low = Point2::new(low.x_m.min(corner.x_m), low.y_m.min(corner.y_m));
            high = Point2::new(high.x_m.max(corner.x_m), high.y_m.max(corner.y_m));
        }
        let GridCoordinates { column: first_column, row: first_row } = geometry.coordinates_of(low);
        let GridCoordinates { column: last_column, row: last_row } = geometry.coordinates_of(high);
        let columns = i32::try_from(geometry.columns()).unwrap_or(i32::MAX);
        let rows = i32::try_from(geometry.rows()).unwrap_or(i32::MAX);
        for row in first_row.max(0)..last_row.saturating_add(1).min(rows).min(GRID_SIDE_MAX) {
            for column in first_column.max(0)..last_column.saturating_add(1).min(columns).min(GRID_SIDE_MAX) {
                let Some(cell) = geometry.index(column, row) else { continue };
                if self.contains(geometry.centre(cell))
                    && let Some(cost) = costs.get_mut(cell)
                {
                    *cost = Costs::LETHAL;
                }
            }
        }
    }
}

/// The lowest speed limit of all zones that hold a point of the map frame; infinite where none does.
#[must_use]
pub fn speed_limit_mps(zones: &[Zone], point_in_map: Point2) -> f32 {
    let limits = zones.iter().filter_map(|zone| match zone.kind {
        ZoneKind::SpeedLimit(limit_mps) if zone.contains(point_in_map) => Some(limit_mps.max(0.0)),
        _ => None,
    });
    limits.fold(f32::INFINITY, f32::min)
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::vec;

    fn square(x_m: f32, kind: ZoneKind) -> Zone {
        let corners = [(x_m, 0.5), (x_m + 1.0, 0.5), (x_m + 1.0, 1.5), (x_m, 1.5)];
        Zone { corners_in_map: corners.iter().map(|&(x, y)| Point2::new(x, y)).collect(), kind }
    }

    #[test]
    fn zones_forbid_and_limit() {
        let geometry = GridGeometry::new(40, 20, 0.1, Point2::default()).unwrap();
        let mut costs = vec![0; 800];
        let zones = [
            square(0.5, ZoneKind::NoGo),
            square(2.0, ZoneKind::SpeedLimit(0.3)),
            square(2.5, ZoneKind::SpeedLimit(0.2)),
        ];
        for zone in &zones {
            zone.forbid(&geometry, &mut costs);
        }
        assert_eq!(costs.iter().filter(|&&cost| cost == Costs::LETHAL).count(), 100);
        assert_eq!(costs[geometry.cell_at(Point2::new(1.0, 1.0)).unwrap()], Costs::LETHAL);
        assert_eq!(speed_limit_mps(&zones, Point2::new(2.2, 1.0)), 0.3);
        assert_eq!(speed_limit_mps(&zones, Point2::new(2.7, 1.0)), 0.2);
        assert_eq!(speed_limit_mps(&zones, Point2::new(1.0, 1.0)), f32::INFINITY);
    }
}
