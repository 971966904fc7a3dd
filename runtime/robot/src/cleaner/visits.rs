//! From a dirty cell to a path over it: one straight pass of the brush over as much of the dirt around it as
//! fits.

use floorguard_mapping::GridCoordinates;
use floorguard_navigation::global::HEADINGS;
use floorguard_navigation::{PathSearch, STRAIGHT, SearchCell};
use floorguard_types::geometry::{Point2, Pose2};
use floorguard_types::motion::{Gear, Waypoint};

use super::ground::Ground;
use super::mission::Cleaner;
use super::path_finder::{STEP_M, Search};
use super::surroundings::Surroundings;
use super::track::Track;

/// Dirt within this distance of a target is passed over with it, metres.
pub(super) const CLUSTER_M: f32 = 0.5;
/// A pass goes on over what lies before the brush for at most this, metres.
pub(super) const AHEAD_M: f32 = 1.3;
/// So much of a way over cells may be a detour round their corners, metres.
const SPARE_M: f32 = 0.5;
/// The brush goes on behind a cell by this, metres.
pub(super) const PAST_M: f32 = 0.15;
/// Shares of what the best straight pass over the dirt would take that a pass is to take: what it leaves costs a second one.
const TAKEN: [f32; 2] = [1.0, 0.7];

/// The run-up to a pass, metres: the robot comes onto its lane, as the first cells lie before the brush.
const RUN_UP_M: f32 = 0.2;

/// Dirt that one pass is to take.
struct Spot {
    /// The cell of the tour.
    target: Point2,
    /// It and the dirty cells around it.
    cells: Vec<Point2>,
    /// Cells that a pass has to take.
    needed: usize,
    /// The nearest that the first of them may lie before the brush, metres.
    run_up_m: f32,
}

impl Spot {
    /// A pass that goes straight on from a pose takes enough, and the target with it.
    fn is_before(&self, ground: &Ground, pose: Pose2) -> bool {
        let is_taken =
            |place: &Point2| ground.is_before(pose, *place, (self.run_up_m, AHEAD_M), ground.lane_m());
        is_taken(&self.target) && self.cells.iter().filter(|place| is_taken(place)).count() >= self.needed
    }
}

/// A little less than the way that is left from a rear axle to the target of a search over the raster, metres; without a way in the
/// raster half as much again as the straight line.
pub(super) fn way_left_m(
    (ground, search): (&Ground, &PathSearch<Vec<SearchCell>>),
    axle: Point2,
    target: Point2,
) -> f32 {
    let cells_m = ground.raster().resolution_m() / STRAIGHT as f32;
    let units = ground.raster().cell_at(axle).and_then(|cell| search.distance(cell));
    let path_m = units.map_or(1.5 * axle.distance(target), |units| units as f32 * cells_m);
    (path_m - SPARE_M).max(0.0)
}

impl Cleaner {
    /// Finds the path to a pass over a cell and over the dirt around it; over the cell alone if there is no
    /// other.
    pub(super) fn plan_to(&mut self, cell: usize, pose: Pose2, now_s: f32) -> bool {
        let target = self.ground.raster().centre(cell);
        let dirty = self.dirty_around(target);
        let [all, most] = TAKEN.map(|share| self.spot((target, share), &dirty));
        let alone = Spot { target, cells: vec![target], needed: 1, run_up_m: 0.05 };
        let mut paths =
            [all, most, alone].into_iter().filter_map(|spot| self.path_before(cell, (pose, now_s), &spot));
        let Some(path) = paths.next() else { return false };
        drop(paths);
        self.begin_pass(path, (cell, &dirty), (pose, now_s));
        true
    }

    /// Drives a path, and from its end straight on over a cell and the dirt before it.
    pub(super) fn begin_pass(
        &mut self,
        mut path: Vec<Waypoint>,
        (cell, dirty): (usize, &[Point2]),
        (pose, now_s): (Pose2, f32),
    ) {
        if let Some(last) = path.last().copied() {
            let around = Surroundings::new(&self.ground, (&self.obstacles, now_s), pose);
            let target = self.ground.raster().centre(cell);
            let past_m = self.pass_m(last.pose_in_map, (target, dirty), &around);
            let end = last.pose_in_map.compose(Pose2::new(past_m, 0.0, 0.0));
            path.push(Waypoint { pose_in_map: end, gear: Gear::Ahead });
        }
        self.track = Track::new(path);
        self.near.is_leaving = false;
        self.target = Some(cell);
    }

    /// Middles of the cells around a place that are to be cleaned.
    fn dirty_around(&self, place: Point2) -> Vec<Point2> {
        let raster = self.ground.raster();
        let GridCoordinates { column, row } = raster.coordinates_of(place);
        let reach = (AHEAD_M * raster.cells_per_metre()).ceil() as i32;
        let cells = (-reach..=reach).flat_map(|dy| (-reach..=reach).map(move |dx| (column + dx, row + dy)));
        let dirty = cells.filter_map(|(column, row)| raster.index(column, row));
        dirty.filter(|cell| self.wanted[*cell]).map(|cell| raster.centre(cell)).collect()
    }

    /// The dirt around a target, with what the best of the straight passes through its middle takes.
    fn spot(&self, (target, share): (Point2, f32), dirty: &[Point2]) -> Spot {
        let near = dirty.iter().copied().filter(|place| place.distance(target) < CLUSTER_M);
        let mut cells: Vec<Point2> = near.collect();
        if cells.is_empty() {
            cells.push(target);
        }
        let count = cells.len() as f32;
        let sum = cells.iter().fold((0.0, 0.0), |(x, y), place| (x + place.x_m, y + place.y_m));
        let taken = |heading: usize| {
            let heading_rad = heading as f32 * std::f32::consts::TAU / HEADINGS as f32;
            let lane = Pose2::new(sum.0 / count, sum.1 / count, heading_rad).inverse();
            cells.iter().filter(|place| lane.transform(**place).y_m.abs() <= self.ground.lane_m()).count()
        };
        let best = (0..HEADINGS / 2).map(taken).max().unwrap_or(0);
        Spot { target, needed: (share * best as f32).ceil() as usize, cells, run_up_m: RUN_UP_M }
    }

    /// How far straight on the robot goes so that the brush passes the target, and all dirt before it while it fits.
    pub(super) fn pass_m(
        &self,
        pose: Pose2,
        (target, dirty): (Point2, &[Point2]),
        around: &Surroundings<'_>,
    ) -> f32 {
        let ahead_m = |place: Point2| pose.inverse().transform(place).x_m - self.ground.brush.offset_m;
        let least_m = ahead_m(target) + PAST_M;
        let lane_m = 0.5 * self.ground.brush.width_m;
        let in_lane = dirty.iter().filter(|place| {
            let in_robot = pose.inverse().transform(**place);
            in_robot.y_m.abs() < lane_m && (0.0..AHEAD_M).contains(&ahead_m(**place))
        });
        let most_m = in_lane.map(|place| ahead_m(*place) + PAST_M).fold(least_m, f32::max);
        let is_free = |path_m: f32| around.is_free(pose.compose(Pose2::new(path_m, 0.0, 0.0)), Gear::Ahead);
        let steps = ((most_m - least_m) / STEP_M).ceil() as i32;
        let more =
            (1..=steps).take_while(|step| is_free(least_m + *step as f32 * STEP_M)).last().unwrap_or(0);
        (least_m + more as f32 * STEP_M).min(most_m).max(least_m)
    }

    /// The path to a pose from where the robot can go straight on over a spot.
    fn path_before(
        &mut self,
        cell: usize,
        (pose, now_s): (Pose2, f32),
        spot: &Spot,
    ) -> Option<Vec<Waypoint>> {
        let (ground, guess, speed_mps) = (&self.ground, &mut self.guess, self.path_finder.pace().speed_mps);
        let around = Surroundings::new(ground, (&self.obstacles, now_s), pose).after(self.refused);
        guess.run(cell, |cell| ground.floor.passable[cell] || ground.floor.reachable[cell]);
        let left_s = |pose: Pose2| {
            Some(way_left_m((ground, guess), Point2::new(pose.x_m, pose.y_m), spot.target) / speed_mps)
        };
        let is_goal = |pose: Pose2| {
            let past_m = pose.inverse().transform(spot.target).x_m - ground.brush.offset_m + PAST_M;
            spot.is_before(ground, pose) && around.is_clear_ahead(pose, past_m)
        };
        let slowness = |pose: Pose2, gear: Gear| around.slowness(pose, gear);
        self.path_finder.find(pose, &Search { slowness, left_s, is_goal })
    }

    /// A path to any pose that is good enough.
    pub(super) fn search(
        &mut self,
        (pose, now_s): (Pose2, f32),
        (left_s, is_goal): (impl Fn(Pose2) -> Option<f32>, impl Fn(Pose2) -> bool),
    ) -> Option<Vec<Waypoint>> {
        let around = Surroundings::new(&self.ground, (&self.obstacles, now_s), pose).after(self.refused);
        let slowness = |pose: Pose2, gear: Gear| around.slowness(pose, gear);
        self.path_finder.find(pose, &Search { slowness, left_s, is_goal })
    }
}
