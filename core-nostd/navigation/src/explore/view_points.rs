//! From where a frontier is looked at, and how far it is from one such place to the next.
//!
//! The place is the first one on the path to the frontier from which the frontier can be seen: the robot need not go
//! where known floor ends, and a goal is always known floor on which it can stand.

use floorguard_mapping::{GridCoordinates, GridGeometry, GridSides};
use floorguard_types::geometry::Point2;
use floorguard_types::number::{count_u32, nearest_f32, saturating_u32, truncating_i32};
use heapless::Vec;

use super::frontier::Frontier;
use super::visit_order::Ways;
use crate::costmap::{CostmapView, Costs, RayCells};
use crate::path_search::{PathSearch, STRAIGHT, SearchCell};

/// View points that are kept: the nearest.
pub const VIEW_POINTS_MAX: usize = 16;
/// Cells of a way that are examined.
const STEPS_MAX: usize = 4_096;
/// Cells of the costmap along the edge of a coarse one.
const EDGE_MAX: i32 = 64;

/// How frontiers are looked at.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ViewConfig {
    /// A frontier is looked at from within this distance, metres.
    pub sight_m: f32,
    /// The robot can stand where it costs less than this.
    pub stand_cost: u8,
    /// Ways are searched on cells of about this edge, metres.
    pub raster_m: f32,
}

/// A place to look from.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ViewPoint {
    /// What is looked at.
    pub frontier: Frontier,
    /// Where the robot's base point stands, map frame.
    pub place_in_map: Point2,
    /// From the robot along known floor, metres.
    pub way_m: f32,
}

/// The nearest view points, in the order of their frontiers.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ViewPoints {
    /// One a frontier.
    pub points: Vec<ViewPoint, VIEW_POINTS_MAX>,
    /// Frontiers that no way leads to.
    pub without_way: u32,
    /// View points beyond the capacity: the farthest.
    pub dropped: u32,
}

/// Ways over known floor, on cells coarser than those of the costmap. `S` stores a [`SearchCell`] and `L` a byte for each.
pub struct ViewSearch<S, L> {
    config: ViewConfig,
    search: PathSearch<S>,
    /// Lowest cost in each cell.
    lowest: L,
    /// Cells of the costmap along an edge of a coarse one.
    edge: i32,
}

impl<S: AsRef<[SearchCell]> + AsMut<[SearchCell]>, L: AsRef<[u8]> + AsMut<[u8]>> ViewSearch<S, L> {
    /// The raster on which ways over a costmap are searched: as many cells must be stored. `None`: no such raster.
    #[must_use]
    pub fn raster(costmap: &GridGeometry, raster_m: f32) -> Option<GridGeometry> {
        let edge = edge_of(costmap, raster_m);
        let side = |count: usize| count_u32(count.div_ceil(edge));
        let sides = GridSides { columns: side(costmap.columns()), rows: side(costmap.rows()) };
        let edge_m = nearest_f32(count_u32(edge)) * costmap.resolution_m();
        GridGeometry::with_sides(sides, edge_m, costmap.origin_in_map())
    }

    /// Over costmaps of this raster. `None`: there is no such raster, or the storage is too small.
    #[must_use]
    pub fn new(costmap: &GridGeometry, config: ViewConfig, (cells, lowest): (S, L)) -> Option<Self> {
        let raster = Self::raster(costmap, config.raster_m)?;
        let count = raster.cell_count();
        let is_enough = cells.as_ref().len() >= count && lowest.as_ref().len() >= count;
        let edge = truncating_i32(edge_of(costmap, config.raster_m));
        is_enough.then(|| Self { config, search: PathSearch::new(raster, cells), lowest, edge })
    }

    /// Where each frontier is looked at from. `costmap` has the raster that this was made for. Cost: one look at every cell, a
    /// search over the coarse ones, and one ray for each cell of the last metres of a way.
    #[must_use]
    pub fn view_points(
        &mut self,
        costmap: CostmapView<'_>,
        robot_in_map: Point2,
        frontiers: &[Frontier],
    ) -> ViewPoints {
        self.lower(costmap);
        let mut found = ViewPoints::default();
        let Some(start) = self.search.geometry().cell_at(robot_in_map) else { return found };
        self.run(start);
        for frontier in frontiers {
            match self.view_point(costmap, frontier) {
                Some(point) => keep(&mut found, point),
                None => found.without_way = found.without_way.saturating_add(1),
            }
        }
        found
    }

    /// Ways between the robot and all of these, over the floor that [`Self::view_points`] saw. Cost: a search for each.
    #[must_use]
    pub fn ways(&mut self, points: &[ViewPoint]) -> Ways {
        let mut ways = Ways::new(points.len().saturating_add(1));
        for (from, point) in points.iter().enumerate() {
            ways.set((0, from.saturating_add(1)), point.way_m);
            let Some(start) = self.search.geometry().cell_at(point.place_in_map) else { continue };
            self.run(start);
            for (to, other) in points.iter().enumerate().skip(from.saturating_add(1)) {
                if let Some(way_m) = self.way_m(other.place_in_map) {
                    ways.set((from.saturating_add(1), to.saturating_add(1)), way_m);
                }
            }
        }
        ways
    }

    /// The way to a place from where the last search began, metres.
    fn way_m(&self, place_in_map: Point2) -> Option<f32> {
        let geometry = self.search.geometry();
        let units = geometry.cell_at(place_in_map).and_then(|cell| self.search.distance(cell))?;
        Some(nearest_f32(units) / nearest_f32(STRAIGHT) * geometry.resolution_m())
    }

    /// Takes the lowest cost of each coarse cell.
    fn lower(&mut self, costmap: CostmapView<'_>) {
        self.lowest.as_mut().fill(Costs::UNKNOWN);
        let (raster, edge) = (*self.search.geometry(), self.edge.max(1));
        for (cell, &cost) in costmap.costs().iter().enumerate() {
            let GridCoordinates { column, row } = costmap.geometry().coordinates(cell);
            let coarse = raster.index(column.div_euclid(edge), row.div_euclid(edge));
            if let Some(lowest) = coarse.and_then(|coarse| self.lowest.as_mut().get_mut(coarse)) {
                *lowest = cost.min(*lowest);
            }
        }
    }

    fn run(&mut self, start: usize) {
        let lowest = self.lowest.as_ref();
        self.search.run(start, |cell| lowest.get(cell).is_some_and(|&cost| cost < Costs::INSCRIBED));
    }

    /// From the frontier towards the robot: the last place from which the frontier is still seen.
    fn view_point(&self, costmap: CostmapView<'_>, frontier: &Frontier) -> Option<ViewPoint> {
        let goal = frontier.goal_in_map;
        let mut cell = self.search.geometry().cell_at(goal)?;
        let mut best = ViewPoint { frontier: *frontier, place_in_map: goal, way_m: self.way_m(goal)? };
        for _ in 0..STEPS_MAX {
            if self.search.geometry().centre(cell).distance(goal) > self.config.sight_m {
                break;
            }
            if let Some(place_in_map) = self.standing_place(costmap, cell)
                && is_in_sight(costmap, place_in_map, goal)
                && let Some(way_m) = self.way_m(place_in_map)
            {
                best = ViewPoint { place_in_map, way_m, ..best };
            }
            let Some(next) = self.search.towards_start(cell) else { break };
            cell = next;
        }
        Some(best)
    }

    /// The cheapest cell of a coarse one, if the robot can stand there.
    fn standing_place(&self, costmap: CostmapView<'_>, coarse: usize) -> Option<Point2> {
        let lowest = *self.lowest.as_ref().get(coarse)?;
        if lowest >= self.config.stand_cost {
            return None;
        }
        let GridCoordinates { column, row } = self.search.geometry().coordinates(coarse);
        let (left, bottom) = (column.saturating_mul(self.edge), row.saturating_mul(self.edge));
        let inside =
            (0..self.edge.min(EDGE_MAX)).flat_map(|y| (0..self.edge.min(EDGE_MAX)).map(move |x| (x, y)));
        let mut cells = inside.filter_map(|(x, y)| {
            let (column, row) = (left.saturating_add(x), bottom.saturating_add(y));
            costmap.geometry().index(column, row).filter(|_| costmap.cost(column, row) == lowest)
        });
        cells.next().map(|cell| costmap.geometry().centre(cell))
    }
}

fn edge_of(costmap: &GridGeometry, raster_m: f32) -> usize {
    let cells = libm::roundf(raster_m * costmap.cells_per_metre());
    floorguard_types::number::exact_usize(saturating_u32(cells).clamp(1, EDGE_MAX.unsigned_abs()))
}

/// Nothing that was seen or never seen lies between.
fn is_in_sight(costmap: CostmapView<'_>, from_in_map: Point2, to_in_map: Point2) -> bool {
    let is_open = |cell: usize| costmap.costs().get(cell).is_some_and(|&cost| cost < Costs::LETHAL);
    RayCells::new(costmap.geometry(), from_in_map, to_in_map).all(is_open)
}

fn keep(found: &mut ViewPoints, point: ViewPoint) {
    if found.points.push(point).is_ok() {
        return;
    }
    found.dropped = found.dropped.saturating_add(1);
    let farthest = found.points.iter_mut().max_by(|a, b| a.way_m.total_cmp(&b.way_m));
    if let Some(farthest) = farthest.filter(|kept| kept.way_m > point.way_m) {
        *farthest = point;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::vec;

    /// A corridor of 12 m with a wall across it that leaves a door of a metre; the far end was never seen.
    #[test]
    fn frontiers_are_seen_from_the_way_to_them() {
        let geometry = GridGeometry::new(120, 20, 0.1, Point2::default()).unwrap();
        let cost = |cell: usize| {
            let GridCoordinates { column, row } = geometry.coordinates(cell);
            match (column, row) {
                (110.., _) => Costs::UNKNOWN,
                (_, 0 | 19) => Costs::LETHAL,
                (60, 0..=9) => Costs::LETHAL,
                _ => Costs::FREE,
            }
        };
        let costs: vec::Vec<u8> = (0..2_400).map(cost).collect();
        let costmap = CostmapView::new(geometry, &costs, 0).unwrap();
        let config = ViewConfig { sight_m: 6.0, stand_cost: Costs::INSCRIBED, raster_m: 0.2 };
        let storage = (vec![SearchCell::EMPTY; 600], vec![0; 600]);
        assert!(ViewSearch::new(&geometry, config, (vec![SearchCell::EMPTY; 599], vec![0; 600])).is_none());
        let mut search = ViewSearch::new(&geometry, config, storage).unwrap();
        let end = Point2::new(10.95, 0.55);
        let frontier = Frontier { cells: 18, centroid_in_map: end, goal_in_map: end, nearest_m: 10.0 };
        let walled = Frontier { goal_in_map: Point2::new(11.5, 0.55), ..frontier };
        let robot = Point2::new(1.05, 0.55);
        let found = search.view_points(costmap, robot, &[frontier, walled]);
        assert_eq!((found.points.len(), found.without_way), (1, 1), "unknown floor is no way");
        let point = found.points[0];
        // From the door on the frontier is in sight; 6 m away at most.
        assert!(point.place_in_map.distance(end) <= 6.0 && point.place_in_map.x_m < 6.6, "{point:?}");
        assert!(is_in_sight(costmap, point.place_in_map, end));
        assert!((point.way_m - 5.0).abs() < 0.8, "{point:?}");
        let ways = search.ways(&found.points);
        assert_eq!((ways.count(), ways.between(0, 1)), (2, point.way_m));
    }
}
