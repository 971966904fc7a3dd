//! Ways between places around obstacles, as straight stretches.

use floorguard_navigation::{PathSearch, SearchCell};
use floorguard_types::geometry::{Point2, Pose2};

use floorguard_robot::site::Floor;

/// A search over the floor with its memory.
pub struct Routes {
    search: PathSearch<Vec<SearchCell>>,
}

impl Routes {
    /// Over the raster of the search.
    pub const fn new(search: PathSearch<Vec<SearchCell>>) -> Self {
        Self { search }
    }

    /// The way to some place at least 0.4 m away; empty where there is none.
    pub fn away(&mut self, floor: &Floor, pose: Pose2) -> Vec<Point2> {
        let here = Point2::new(pose.x_m, pose.y_m);
        for attempt in 0..64 {
            let angle = pose.heading_rad + 0.4 * attempt as f32;
            let distance = 0.5 + 0.01 * attempt as f32;
            let there = Point2::new(here.x_m + distance * angle.cos(), here.y_m + distance * angle.sin());
            if floor.is_clear(here, there) {
                return vec![there];
            }
        }
        let Some(cell) = floor.nearest_passable(here) else { return vec![] };
        let mut far = None;
        self.search.run_until(
            cell,
            |c| floor.passable[c],
            |c| {
                let is_far = floor.cells.centre(c).distance(here) > 0.4;
                far = is_far.then_some(c);
                is_far
            },
        );
        far.map_or_else(Vec::new, |far| self.between(floor, here, floor.cells.centre(far)))
    }

    /// Waypoints from here to there around obstacles.
    pub fn between(&mut self, floor: &Floor, here: Point2, there: Point2) -> Vec<Point2> {
        if floor.is_clear(here, there) {
            return vec![there];
        }
        let (Some(from), Some(to)) = (floor.nearest_passable(here), floor.nearest_passable(there)) else {
            return vec![there];
        };
        self.search.run_until(to, |c| floor.passable[c], |c| c == from);
        let mut cells = vec![from];
        let mut cell = from;
        for _ in 0..floor.cells.cell_count() {
            let Some(next) = self.search.towards_start(cell) else { break };
            cells.push(next);
            cell = next;
        }
        let points: Vec<Point2> = cells.iter().map(|&c| floor.cells.centre(c)).chain([there]).collect();
        // Pulls the string tight: on to the last point that is in clear sight.
        let mut waypoints = Vec::new();
        let mut anchor = here;
        let mut index = 0;
        while index < points.len() {
            let last = (index..points.len()).rev().find(|&i| floor.is_clear(anchor, points[i]));
            let next = last.unwrap_or(index);
            anchor = points[next];
            waypoints.push(anchor);
            index = next + 1;
        }
        waypoints
    }
}
