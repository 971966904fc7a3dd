//! Which pass comes next: the straight pass over dirt that takes the most cells for its time.
//!
//! A tour over cells knows distances alone. Among shelves the time of a long robot goes into turns and backing: of three minutes in
//! a supermarket more than one. The search that finds paths knows what they take, and asks at each pose that it reaches what a pass from
//! there would take away.

use floorguard_mapping::GridCoordinates;
use floorguard_navigation::global::Worth;
use floorguard_types::geometry::{Point2, Pose2};
use floorguard_types::motion::Gear;

use super::ground::Ground;
use super::mission::Cleaner;
use super::path_finder::Search;
use super::surroundings::Surroundings;
use super::visits::{AHEAD_M, PAST_M};

/// The first cell of a pass lies at least this far before the brush, metres: nearer than where a path is planned to one target, because
/// the next best pose counts.
const FIRST_M: f32 = 0.1;
/// What every pass costs beside its way, seconds: so much is worth going for one that takes all of a patch.
const PASS_S: f32 = 2.0;
/// Dirt farther than this is a matter of the tour, seconds.
const NEAR_S: f32 = 60.0;
/// Cells that one pass takes lie within this distance of each of them, metres: the diagonal of what it takes.
const TOGETHER_M: f32 = 1.35;
/// Of more open cells than this it is not counted which lie together: a pass is taken to be full then.
const COUNTED_MAX: usize = 1_024;

/// Cells that are to be cleaned now.
struct OpenCells {
    /// Of each cell of the raster whether it is one of them.
    is_open: Vec<bool>,
    /// Their middles, map frame.
    places: Vec<Point2>,
}

impl OpenCells {
    /// No pass takes more cells than this.
    fn most_in_pass(&self, ground: &Ground) -> usize {
        // A row of cells more than fits each way: the pass may lie across the raster.
        let rows = |length_m: f32| (length_m * ground.raster().cells_per_metre()).ceil() as usize + 1;
        let full = rows(AHEAD_M - FIRST_M) * rows(2.0 * ground.lane_m());
        if self.places.len() > COUNTED_MAX {
            return full;
        }
        let together =
            |place: &Point2| self.places.iter().filter(|at| at.distance(*place) < TOGETHER_M).count();
        full.min(self.places.iter().map(together).max().unwrap_or(0))
    }
}

/// What a straight pass from a pose takes.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
struct Taken {
    cells: usize,
    /// The last one before the brush, metres.
    far_m: f32,
    /// The first one, and how far before the brush it is, metres.
    first: Option<(usize, f32)>,
}

impl Taken {
    fn from(ground: &Ground, pose: Pose2, open: &OpenCells) -> Self {
        let (raster, to_robot, aside_m) = (ground.raster(), pose.inverse(), ground.lane_m());
        let corner = |ahead_m: f32, side: f32| {
            let ahead_m = ground.brush.offset_m + ahead_m;
            raster.coordinates_of(pose.transform(Point2::new(ahead_m, side * aside_m)))
        };
        let corners = [(FIRST_M, 1.0), (FIRST_M, -1.0), (AHEAD_M, 1.0), (AHEAD_M, -1.0)]
            .map(|(ahead_m, side)| corner(ahead_m, side));
        let span = |of: fn(&GridCoordinates) -> i32| {
            let (first, last) = (corners.iter().map(of).min(), corners.iter().map(of).max());
            first.unwrap_or(0)..=last.unwrap_or(-1)
        };
        let (columns, rows) = (span(|at| at.column), span(|at| at.row));
        let mut taken = Self::default();
        for (column, row) in rows.flat_map(|row| columns.clone().map(move |column| (column, row))) {
            let Some(cell) = raster.index(column, row).filter(|cell| open.is_open[*cell]) else { continue };
            let in_robot = to_robot.transform(raster.centre(cell));
            let ahead_m = in_robot.x_m - ground.brush.offset_m;
            if !(FIRST_M..=AHEAD_M).contains(&ahead_m) || in_robot.y_m.abs() > aside_m {
                continue;
            }
            taken.cells += 1;
            taken.far_m = taken.far_m.max(ahead_m);
            if taken.first.is_none_or(|(_, first_m)| ahead_m < first_m) {
                taken.first = Some((cell, ahead_m));
            }
        }
        taken
    }
}

/// The best pass so far: seconds for each cell that it takes, and its first cell.
#[derive(Clone, Copy, Debug)]
struct BestPass {
    seconds_a_cell: f32,
    target: Option<usize>,
}

impl Cleaner {
    /// Cells that are to be cleaned now: of those that can be visited the ones with the fewest passes. What a pass has left is done on
    /// another round: at once it would cost a turn, among the same people, and where the pose is in doubt a second pass from there
    /// proves no more than the first.
    fn open_cells(&self) -> OpenCells {
        let mut is_open = self.wanted.clone();
        self.postponed.iter().for_each(|(cell, _)| is_open[*cell] = false);
        let open = || (0..is_open.len()).filter(|cell| is_open[*cell]);
        let least = open().map(|cell| self.passes[cell]).min();
        let now: Vec<usize> = open().filter(|cell| Some(self.passes[*cell]) == least).collect();
        is_open.fill(false);
        now.iter().for_each(|cell| is_open[*cell] = true);
        let places = now.into_iter().map(|cell| self.ground.raster().centre(cell)).collect();
        OpenCells { is_open, places }
    }

    /// Finds the way to the pass that takes the most cells for its time, and over it; false: none is near.
    pub(super) fn plan_best_pass(&mut self, pose: Pose2, now_s: f32) -> bool {
        let open = self.open_cells();
        if open.places.is_empty() {
            return false;
        }
        let most = open.most_in_pass(&self.ground) as f32;
        let ground = &self.ground;
        let around = Surroundings::new(ground, (&self.obstacles, now_s), pose).after(self.refused);
        let speed_mps = self.path_finder.pace().speed_mps;
        let mut best = BestPass { seconds_a_cell: f32::INFINITY, target: None };
        let judge = |at: Pose2, way_s: f32| {
            if way_s > NEAR_S || (way_s + PASS_S) / most >= best.seconds_a_cell {
                return Worth::Enough;
            }
            let taken = Taken::from(ground, at, &open);
            let pass_m = taken.far_m + PAST_M;
            let seconds_a_cell = (way_s + pass_m / speed_mps + PASS_S) / taken.cells as f32;
            if seconds_a_cell >= best.seconds_a_cell || !around.is_clear_ahead(at, pass_m) {
                return Worth::Less;
            }
            best = BestPass { seconds_a_cell, target: taken.first.map(|(cell, _)| cell) };
            Worth::Best
        };
        let slowness = |pose: Pose2, gear: Gear| around.slowness(pose, gear);
        let search = Search { slowness, left_s: |_: Pose2| Some(0.0), is_goal: |_: Pose2| false };
        let found = self.path_finder.find_best(pose, &search, judge);
        let (Some(path), Some(cell)) = (found, best.target) else { return false };
        self.begin_pass(path, (cell, &open.places), (pose, now_s));
        true
    }
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use super::*;
    use crate::cleaner::mission::SharedWatch;
    use crate::cleaner::plan::MissionPlan;
    use crate::cleaner::store::Store;
    use floorguard_configuration::{EXAMPLE, parse};
    use floorguard_types::motion::Waypoint;

    /// A robot in the aisle of a supermarket, looking along it, with dirt at these places alone.
    fn with_dirt_at(places: &[Point2]) -> Cleaner {
        let robot = parse("robot.toml", EXAMPLE).unwrap().robot;
        let store = Store::Memory(Arc::default());
        let mut cleaner =
            Cleaner::new(&MissionPlan::supermarket(), &robot, (SharedWatch::default(), store)).unwrap();
        for place in places {
            let cell = cleaner.ground.raster().cell_at(*place).unwrap();
            cleaner.wanted[cell] = true;
        }
        cleaner
    }

    /// Where the pass that was found begins, and the first place that it takes.
    fn found(cleaner: &mut Cleaner) -> Option<Point2> {
        let pose = cleaner.pose();
        cleaner.plan_best_pass(pose, 0.0).then(|| cleaner.ground.raster().centre(cleaner.target.unwrap()))
    }

    #[test]
    fn turning_costs_more_than_distance() {
        let behind = Point2::new(-1.0, 0.05);
        let ahead = Point2::new(2.5, 0.05);
        let mut cleaner = with_dirt_at(&[behind, ahead]);
        assert!(found(&mut cleaner).unwrap().distance(ahead) < 0.1);
        let is_ahead = |at: &Waypoint| at.gear == Gear::Ahead;
        assert!(cleaner.track.rest().iter().all(is_ahead), "{:?}", cleaner.track.rest());
        assert!(
            found(&mut with_dirt_at(&[behind])).unwrap().distance(behind) < 0.1,
            "where there is no other"
        );
    }

    #[test]
    fn patch_is_worth_a_longer_way() {
        let near = Point2::new(1.2, -0.6);
        let patch = [(2.5, 0.05), (2.6, 0.05), (2.5, 0.15), (2.6, 0.15), (2.7, 0.05), (2.7, 0.15)];
        let patch = patch.map(|(x_m, y_m)| Point2::new(x_m, y_m));
        let both: Vec<Point2> = patch.iter().copied().chain([near]).collect();
        let mut cleaner = with_dirt_at(&both);
        assert!(found(&mut cleaner).unwrap().distance(patch[0]) < 0.2);
        let end = cleaner.track.rest().last().unwrap().pose_in_map;
        let brush_m = end.inverse().transform(patch[4]).x_m - cleaner.ground.brush.offset_m;
        assert!(brush_m < 0.0, "the brush has passed the last of it: {brush_m}");
    }

    #[test]
    fn passed_and_postponed_dirt_waits() {
        let (passed, fresh) = (Point2::new(1.2, 0.05), Point2::new(3.5, 0.05));
        let mut cleaner = with_dirt_at(&[passed, fresh]);
        let cell = cleaner.ground.raster().cell_at(passed).unwrap();
        cleaner.passes[cell] = 1;
        assert!(found(&mut cleaner).unwrap().distance(fresh) < 0.1);
        let fresh_cell = cleaner.ground.raster().cell_at(fresh).unwrap();
        (cleaner.passes[cell], cleaner.passes[fresh_cell]) = (2, 1);
        assert!(found(&mut cleaner).unwrap().distance(fresh) < 0.1, "round by round");
        cleaner.postponed.push((fresh_cell, 5.0));
        assert!(found(&mut cleaner).unwrap().distance(passed) < 0.1);
        cleaner.postponed.push((cell, 5.0));
        assert_eq!(found(&mut cleaner), None);
    }

    /// The search ends by this bound: a pass that took more would be missed.
    #[test]
    fn no_pass_takes_more_than_the_bound() {
        let mut cleaner = with_dirt_at(&[]);
        let raster = *cleaner.ground.raster();
        for (dense, count) in [(true, 17_000), (false, 40)] {
            for cell in 0..cleaner.wanted.len() {
                let place = raster.centre(cell);
                let is_spill = place.distance(Point2::new(3.0, 0.0)) < 0.35;
                cleaner.wanted[cell] = if dense { cleaner.ground.floor.reachable[cell] } else { is_spill };
            }
            let open = cleaner.open_cells();
            assert!(open.places.len().abs_diff(count) < count / 5, "{}", open.places.len());
            let most = open.most_in_pass(&cleaner.ground);
            let poses = (0..4_000).map(|step| {
                let turn = step as f32;
                Pose2::new(2.0 + (0.013 * turn) % 2.0, (0.0071 * turn) % 1.0 - 0.5, 0.37 * turn)
            });
            let found = poses.map(|pose| Taken::from(&cleaner.ground, pose, &open).cells).max().unwrap();
            assert!(found <= most && 4 * found > 3 * most, "{found} of at most {most}");
        }
    }
}
