//! The floor as this robot can use it: where it fits, which way round, and which cells its brush can pass over.

use std::f32::consts::FRAC_PI_2;

use floorguard_cleaning::Brush;
use floorguard_mapping::{GridCoordinates, GridGeometry};
use floorguard_types::geometry::{Point2, Pose2};
use floorguard_types::motion::Gear;

use super::areas::AreaKind;
use super::body::{Body, DISCS};
use super::path_finder::{PathFinder, STEP_M};
use super::plan::MissionPlan;
use crate::site::Floor;

/// Cells this near to the end of the brush are not counted on, metres: the error of the distance driven.
const RIM_M: f32 = 0.08;
/// Cells under the brush are found in steps of half a cell, metres.
const FINE_M: f32 = 0.05;
/// Headings of lanes: along the axes of the map, both ways.
pub(super) const QUARTERS: usize = 4;
/// A heading this near to one of these counts as it, radians: half a heading of the lattice.
const HEADED_RAD: f32 = 0.2;

/// The floor of a mission.
pub struct Ground {
    /// Map, distances and raster; `reachable` are the cells that the mission answers for, `passable` those where the rear
    /// axle can be.
    pub floor: Floor,
    /// The footprint discs of the robot.
    pub body: Body,
    /// The brush.
    pub brush: Brush,
    /// Dirt expected before the mission, units a cell.
    pub expected: Vec<f32>,
    /// For each quarter of a turn the cells where the rear axle can be with that heading without having backed.
    headed: [Vec<bool>; QUARTERS],
}

impl Ground {
    /// Prepares the floor of a plan.
    ///
    /// # Errors
    /// The plan holds no map, or the robot fits nowhere.
    pub fn new(plan: &MissionPlan, (body, brush): (Body, Brush)) -> anyhow::Result<Self> {
        let mut floor = Floor::new("mission", plan.occupancy()?, body.ahead.radius_m)?;
        if plan.has(AreaKind::NoGo) {
            floor.close(|place| plan.lies_in(AreaKind::NoGo, place))?;
        }
        floor.start = plan.start_pose();
        let expected = plan.expected_on(&floor.cells);
        let headed = std::array::from_fn(|_| Vec::new());
        Ok(Self { floor, body, brush, expected, headed })
    }

    /// The mission answers for the areas that its plan names, if it names any.
    pub fn keep_to_areas(&mut self, plan: &MissionPlan) {
        if plan.has(AreaKind::Clean) {
            let raster = self.floor.cells;
            for (cell, reachable) in self.floor.reachable.iter_mut().enumerate() {
                *reachable &= plan.lies_in(AreaKind::Clean, raster.centre(cell));
            }
        }
    }

    /// Finds out where the robot can go, from the start.
    pub fn explore(&mut self, path_finder: &mut PathFinder) {
        let raster = self.floor.cells;
        let mut axle = vec![false; raster.cell_count()];
        let mut swept = vec![false; raster.cell_count()];
        let mut headed: [Vec<bool>; QUARTERS] = std::array::from_fn(|_| vec![false; raster.cell_count()]);
        path_finder.reach(
            self.floor.start,
            |pose, gear| self.is_free(pose, gear),
            |pose| {
                if let Some(cell) = raster.cell_at(Point2::new(pose.x_m, pose.y_m)) {
                    axle[cell] = true;
                    let quarter = (pose.heading_rad / FRAC_PI_2).round();
                    if (pose.heading_rad - quarter * FRAC_PI_2).abs() < HEADED_RAD {
                        headed[(quarter as i32).rem_euclid(QUARTERS as i32) as usize][cell] = true;
                    }
                }
                let next = pose.compose(Pose2::new(STEP_M, 0.0, 0.0));
                if self.is_free(next, Gear::Ahead) {
                    self.under_brush(pose, STEP_M, |cell| swept[cell] = true);
                }
            },
        );
        let is_floor = |cell: usize| {
            self.floor.clearance.clearance_m(raster.centre(cell)) >= 0.5 * raster.resolution_m()
        };
        self.floor.reachable = (0..raster.cell_count()).map(|cell| swept[cell] && is_floor(cell)).collect();
        self.floor.passable = axle;
        self.headed = headed;
    }

    /// The rear axle can be there, or in a cell beside it, heading along an axis of the map, without having backed.
    pub(super) fn is_headed(&self, place: Point2, quarter: usize) -> bool {
        let raster = &self.floor.cells;
        let GridCoordinates { column, row } = raster.coordinates_of(place);
        let around = (-1..=1).flat_map(|dy| (-1..=1).map(move |dx| (dx, dy)));
        let cells = around.filter_map(|(dx, dy)| raster.index(column + dx, row + dy));
        self.headed.get(quarter).is_some_and(|headed| cells.into_iter().any(|cell| headed.get(cell) == Some(&true)))
    }

    /// The robot fits there, as far as the map shows.
    pub fn is_free(&self, pose: Pose2, gear: Gear) -> bool {
        // What lies ahead is left behind when driving backwards.
        let (discs, count) = match gear {
            Gear::Ahead | Gear::Spin => (&self.body.ahead, DISCS),
            Gear::Back => (&self.body.back, DISCS - 1),
        };
        let clearance_m = |place: &Point2| self.floor.clearance.clearance_m(*place);
        discs.places(pose).iter().take(count).all(|place| clearance_m(place) >= discs.radius_m)
    }

    /// Cells over which the whole brush passes while the robot goes straight on by `path_m`.
    pub(super) fn under_brush(&self, pose: Pose2, path_m: f32, mut cell: impl FnMut(usize)) {
        let reach_m = self.lane_m();
        let count = |length_m: f32| (length_m / FINE_M).floor() as i32;
        for ahead in 0..=count(path_m) {
            for aside in -count(reach_m)..=count(reach_m) {
                let ahead_m = self.brush.offset_m + ahead as f32 * FINE_M;
                let place = pose.transform(Point2::new(ahead_m, aside as f32 * FINE_M));
                self.floor.cells.cell_at(place).into_iter().for_each(&mut cell);
            }
        }
    }

    /// Half of the lane that is counted on as passed over, metres.
    pub fn lane_m(&self) -> f32 {
        0.5 * self.brush.width_m - RIM_M
    }

    /// A place lies within these distances ahead of the brush and at most this far aside, metres.
    pub fn is_before(&self, pose: Pose2, place: Point2, (from_m, to_m): (f32, f32), aside_m: f32) -> bool {
        let in_robot = pose.inverse().transform(place);
        let ahead_m = in_robot.x_m - self.brush.offset_m;
        (from_m..=to_m).contains(&ahead_m) && in_robot.y_m.abs() <= aside_m
    }

    /// The raster.
    pub const fn raster(&self) -> &GridGeometry {
        &self.floor.cells
    }
}
