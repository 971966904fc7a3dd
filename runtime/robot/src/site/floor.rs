//! The floor of a mission: what is free, what the robot can reach, and the raster of cells that it answers for.

use std::collections::{BTreeMap, BTreeSet};

use floorguard_mapping::{DistanceField, Grid, GridCoordinates, GridGeometry, Occupancy, fill_distances};
use floorguard_navigation::{PathSearch, SearchCell};
use floorguard_types::geometry::{Point2, Pose2};

use super::ros_map::OccupancyMap;

/// Edge of a cell, metres (book, Cleaning: Dirt model).
pub const CELL_M: f32 = 0.1;
/// Cells that one mission can answer for: the hosted profile.
pub const CELLS_MAX: usize = 65_536;
/// Half the length of a pass over a cell, metres: half the cell's diagonal and a little for doubt.
const PASS_REACH_M: f32 = 0.085;
/// Directions and share of that length of which one must be clear for a cell to be cleanable.
const PASS_DIRECTIONS: u8 = 16;
const PASS_SHARE: f32 = 0.75;
/// Kept between the robot's rim and obstacles when planning, beyond its radius, metres.
const MARGIN_M: f32 = 0.02;

/// The robot knows where it is as long as something that a beam can hit is within this distance, metres: a little less than
/// its scanner reaches.
const SIGHT_M: i32 = 25;

/// A floor with everything that a mission looks up.
pub struct Floor {
    /// Name for reports.
    pub name: String,
    /// The map as it was read.
    pub occupancy: OccupancyMap,
    /// Distance to what a beam can hit.
    pub surfaces: DistanceField<Vec<u8>>,
    /// Distance to what is not free floor, seen or not.
    pub clearance: DistanceField<Vec<u8>>,
    /// The raster of cells.
    pub cells: GridGeometry,
    /// The robot's centre may stand there, for every cell.
    pub passable: Vec<bool>,
    /// The cell can be reached from the start, is free all over, and the brush can pass over the whole of it: the
    /// mission answers for it.
    pub reachable: Vec<bool>,
    /// Cells of free floor, reachable or not.
    pub free_cells: usize,
    /// Cells that can be reached, but from where no wall is seen: never claimed, for nobody knows where the robot is there.
    pub unseen_cells: usize,
    /// Free floor beyond the raster: too large for one mission, never claimed.
    pub beyond_capacity_m2: f32,
    /// Where a mission starts.
    pub start: Pose2,
    /// Radius of the robot, metres.
    pub robot_radius_m: f32,
}

impl Floor {
    /// Prepares a map for a round robot.
    ///
    /// # Errors
    /// No floor on which the robot fits.
    pub fn new(name: &str, occupancy: OccupancyMap, robot_radius_m: f32) -> anyhow::Result<Self> {
        let fine = *occupancy.geometry();
        let field = |is_obstacle: &dyn Fn(usize) -> bool| -> anyhow::Result<DistanceField<Vec<u8>>> {
            let mut field = Grid::new(fine, vec![0_u8; fine.cell_count()])?;
            let mut scratch = Grid::new(fine, vec![0_u8; fine.cell_count()])?;
            fill_distances(&mut field, &mut scratch, is_obstacle);
            Ok(field)
        };
        let is_occupied = |i: usize| occupancy.get(i) == Some(&Occupancy::Occupied);
        // A beam ends on the face of a wall. Were its inside as good an explanation, a robot that sees one wall would
        // believe to be nearer to it than it is.
        let surfaces = field(&|i| {
            let GridCoordinates { column, row } = fine.coordinates(i);
            let is_face = || {
                let around = (-1..=1).flat_map(|dy| (-1..=1).map(move |dx| (column + dx, row + dy)));
                around.filter_map(|(x, y)| fine.index(x, y)).any(|n| !is_occupied(n))
            };
            is_occupied(i) && is_face()
        })?;
        let clearance = field(&|i| occupancy.get(i) != Some(&Occupancy::Free))?;
        let (cells, beyond) = raster(&occupancy, &clearance)?;
        let mut floor = Self {
            name: name.to_owned(),
            occupancy,
            surfaces,
            clearance,
            cells,
            passable: Vec::new(),
            reachable: Vec::new(),
            free_cells: 0,
            unseen_cells: 0,
            beyond_capacity_m2: beyond,
            start: Pose2::default(),
            robot_radius_m,
        };
        floor.find_reachable()?;
        Ok(floor)
    }

    /// The robot stays away from these places as from a wall, but its scanner sees through them.
    ///
    /// # Errors
    /// The map has no size.
    pub fn close(&mut self, is_closed: impl Fn(Point2) -> bool) -> anyhow::Result<()> {
        let fine = *self.occupancy.geometry();
        let mut scratch = Grid::new(fine, vec![0_u8; fine.cell_count()])?;
        let occupancy = &self.occupancy;
        fill_distances(&mut self.clearance, &mut scratch, |i| {
            occupancy.get(i) != Some(&Occupancy::Free) || is_closed(fine.centre(i))
        });
        Ok(())
    }

    /// Gives up the cells without a wall in sight, by blocks of a metre.
    ///
    /// # Errors
    /// None is left.
    pub fn keep_in_sight(&mut self) -> anyhow::Result<()> {
        let block = |place: Point2| ((place.x_m.floor()) as i32, (place.y_m.floor()) as i32);
        let fine = *self.occupancy.geometry();
        let occupied = |i: &usize| self.occupancy.get(*i) == Some(&Occupancy::Occupied);
        let walls: BTreeSet<(i32, i32)> =
            (0..fine.cell_count()).filter(occupied).map(|i| block(fine.centre(i))).collect();
        let mut seen: BTreeMap<(i32, i32), bool> = BTreeMap::new();
        for (cell, reachable) in self.reachable.iter_mut().enumerate() {
            let (x, y) = block(self.cells.centre(cell));
            let is_seen = *seen.entry((x, y)).or_insert_with(|| {
                let columns = x - SIGHT_M..=x + SIGHT_M;
                columns.flat_map(|column| walls.range((column, y - SIGHT_M)..=(column, y + SIGHT_M))).any(
                    |wall| {
                        let (dx, dy) = (wall.0 - x, wall.1 - y);
                        dx * dx + dy * dy <= SIGHT_M * SIGHT_M
                    },
                )
            });
            self.unseen_cells += usize::from(*reachable && !is_seen);
            *reachable &= is_seen;
        }
        let any = self.reachable.iter().any(|&reachable| reachable);
        let remedy = match walls.is_empty() {
            true => {
                "; no pixel of the map is dark enough for a wall: write a .yaml with a lower occupied_thresh"
            }
            false => "",
        };
        anyhow::ensure!(
            any || self.unseen_cells == 0,
            "no wall within {SIGHT_M} m of the floor: a robot could not know where it is there{remedy}"
        );
        Ok(())
    }

    fn find_reachable(&mut self) -> anyhow::Result<()> {
        let count = self.cells.cell_count();
        let centre = |i| self.cells.centre(i);
        let needed = self.robot_radius_m + MARGIN_M;
        self.passable = (0..count).map(|i| self.clearance.clearance_m(centre(i)) >= needed).collect();
        // A cell is free if its circumscribed circle, less half a pixel, holds nothing else.
        let free: Vec<bool> =
            (0..count).map(|i| self.clearance.clearance_m(centre(i)) >= 0.5 * CELL_M).collect();
        self.free_cells = free.iter().filter(|&&f| f).count();
        let mut search = PathSearch::new(self.cells, vec![SearchCell::EMPTY; count]);
        let mut seen = vec![false; count];
        let mut largest: Vec<usize> = Vec::new();
        for start in 0..count {
            if !self.passable[start] || seen[start] {
                continue;
            }
            search.run(start, |i| self.passable[i]);
            let part: Vec<usize> = (0..count).filter(|&i| search.distance(i).is_some()).collect();
            part.iter().for_each(|&i| seen[i] = true);
            if part.len() > largest.len() {
                largest = part;
            }
        }
        anyhow::ensure!(!largest.is_empty(), "a robot of {} m radius fits nowhere", self.robot_radius_m);
        self.reachable = vec![false; count];
        for &cell in &largest {
            self.reachable[cell] = free[cell] && self.can_be_passed(self.cells.centre(cell));
        }
        self.passable = vec![false; count];
        largest.iter().for_each(|&i| self.passable[i] = true);
        let roomiest = largest.iter().copied().max_by(|&a, &b| {
            let clearance = |i| self.clearance.clearance_m(centre(i));
            clearance(a).total_cmp(&clearance(b)).then(b.cmp(&a))
        });
        let point = centre(roomiest.unwrap_or(0));
        self.start = Pose2::new(point.x_m, point.y_m, 0.0);
        Ok(())
    }

    /// A straight pass over the cell around `centre` is possible. Without one its rim would stay dirty.
    fn can_be_passed(&self, centre: Point2) -> bool {
        (0..PASS_DIRECTIONS / 2).any(|direction| {
            let angle = f32::from(direction) * (std::f32::consts::TAU / f32::from(PASS_DIRECTIONS));
            let (sin, cos) = libm::sincosf(angle);
            let (dx, dy) = (PASS_SHARE * PASS_REACH_M * cos, PASS_SHARE * PASS_REACH_M * sin);
            let end = |sign: f32| Point2::new(centre.x_m + sign * dx, centre.y_m + sign * dy);
            self.is_clear(end(-1.0), end(1.0))
        })
    }

    /// The robot's centre can go straight from one point to the other.
    pub fn is_clear(&self, from: Point2, to: Point2) -> bool {
        self.is_clear_by(from, to, self.robot_radius_m + MARGIN_M)
    }

    /// As [`Self::is_clear`] with a given distance from obstacles.
    pub fn is_clear_by(&self, from: Point2, to: Point2, clearance_m: f32) -> bool {
        let steps = (from.distance(to) / 0.025).ceil().max(1.0) as usize;
        (0..=steps).all(|step| {
            let t = step as f32 / steps as f32;
            let point = Point2::new(from.x_m + t * (to.x_m - from.x_m), from.y_m + t * (to.y_m - from.y_m));
            self.clearance.clearance_m(point) >= clearance_m
        })
    }

    /// Area the mission answers for, m².
    pub fn reachable_m2(&self) -> f32 {
        self.reachable.iter().filter(|&&r| r).count() as f32 * CELL_M * CELL_M
    }

    /// The passable cell nearest to a point, within half a metre.
    pub fn nearest_passable(&self, point: Point2) -> Option<usize> {
        let GridCoordinates { column, row } = self.cells.coordinates_of(point);
        (-5..=5)
            .flat_map(|dy| (-5..=5).map(move |dx| (dx, dy)))
            .filter_map(|(dx, dy)| self.cells.index(column + dx, row + dy))
            .filter(|&cell| self.passable[cell])
            .min_by(|&a, &b| {
                let distance = |cell| self.cells.centre(cell).distance(point);
                distance(a).total_cmp(&distance(b)).then(a.cmp(&b))
            })
    }
}

/// The raster over all free floor or, where that is more than a mission can hold, over the part around the middle of
/// it. Returns the free area that is left out.
fn raster(
    occupancy: &OccupancyMap,
    clearance: &DistanceField<Vec<u8>>,
) -> anyhow::Result<(GridGeometry, f32)> {
    let fine = occupancy.geometry();
    let free: Vec<GridCoordinates> = (0..fine.cell_count())
        .filter(|&i| clearance.get(i).is_some_and(|&cm| cm >= 10))
        .map(|i| fine.coordinates(i))
        .collect();
    anyhow::ensure!(!free.is_empty(), "the map shows no free floor");
    let mut xs: Vec<i32> = free.iter().map(|p| p.column).collect();
    let mut ys: Vec<i32> = free.iter().map(|p| p.row).collect();
    xs.sort_unstable();
    ys.sort_unstable();
    let pixel = fine.resolution_m();
    let cells = |from: i32, to: i32| ((to - from + 1) as f32 * pixel / CELL_M).ceil() as usize + 2;
    let (all_wide, all_high) = (cells(xs[0], xs[xs.len() - 1]), cells(ys[0], ys[ys.len() - 1]));
    let wide = all_wide.min((CELLS_MAX / all_high.min(256)).max(1));
    let high = all_high.min(CELLS_MAX / wide);
    let origin = fine.origin_in_map();
    let corner = |sorted: &[i32], count: usize, all: usize, origin: f32| {
        if count == all {
            return origin + sorted[0] as f32 * pixel - CELL_M;
        }
        let middle = sorted[sorted.len() / 2] as f32 * pixel;
        let low = sorted[0] as f32 * pixel;
        let high = sorted[sorted.len() - 1] as f32 * pixel - count as f32 * CELL_M;
        origin + (middle - 0.5 * count as f32 * CELL_M).clamp(low, high.max(low))
    };
    let corner =
        Point2::new(corner(&xs, wide, all_wide, origin.x_m), corner(&ys, high, all_high, origin.y_m));
    let geometry = u16::try_from(wide)
        .ok()
        .zip(u16::try_from(high).ok())
        .and_then(|(w, h)| GridGeometry::new(w, h, CELL_M, corner))
        .ok_or_else(|| anyhow::anyhow!("the map makes no raster"))?;
    let outside = (0..fine.cell_count())
        .filter(|&i| occupancy.get(i) == Some(&Occupancy::Free))
        .filter(|&i| geometry.cell_at(fine.centre(i)).is_none())
        .count();
    Ok((geometry, outside as f32 * pixel * pixel))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A hall of 80 x 6 m with one wall at its end: claimed may be what is near it.
    #[test]
    fn nothing_is_claimed_where_no_wall_is_seen() {
        let geometry = GridGeometry::new(800, 60, 0.1, Point2::default()).unwrap();
        let map = |walls: u16| {
            let state = |i: usize| {
                let is_wall = geometry.coordinates(i).column < i32::from(walls);
                if is_wall { Occupancy::Occupied } else { Occupancy::Free }
            };
            Grid::new(geometry, (0..geometry.cell_count()).map(state).collect::<Vec<_>>()).unwrap()
        };
        let mut floor = Floor::new("hall", map(3), 0.17).unwrap();
        floor.keep_in_sight().unwrap();
        let farthest = (0..floor.cells.cell_count()).filter(|&cell| floor.reachable[cell]);
        let farthest_m = farthest.map(|cell| floor.cells.centre(cell).x_m).fold(0.0, f32::max);
        assert!(farthest_m > 24.0 && farthest_m < 27.0, "{farthest_m}");
        assert!(floor.unseen_cells > 20_000, "{}", floor.unseen_cells);
        let nothing = Floor::new("field", map(0), 0.17).unwrap().keep_in_sight().unwrap_err().to_string();
        assert!(nothing.contains("no wall within 25 m") && nothing.contains("occupied_thresh"), "{nothing}");
    }
}
