//! What drives: ours, ours that takes people for standing, the dynamic window, and a robot that stands until the path is free.

use floorguard_mapping::{GridGeometry, GridSides};
use floorguard_navigation::costmap::{CostmapView, add_people};
use floorguard_navigation::local::{
    Dwa, DwaScratch, LocalPlanner as _, LocalSituation, Mppi, MppiSample, StepCell,
};
use floorguard_navigation::path::{FollowLimits, FollowState, PathFollower};
use floorguard_robot::navigator::{GuardModel, LocalPlanning};
use floorguard_types::geometry::{Point2, Pose2, Twist2};
use floorguard_types::motion::{Gear, MovingPerson, Waypoint};

/// Cells of the window around the robot, metres, and how many along a side: as the navigator's.
pub const CELL_M: f32 = 0.05;
const SIDE: u32 = 160;
/// Spacing of the waypoints, and distance from the path beyond which it is planned again, metres.
const SPACING_M: f32 = 0.1;
const OFF_M: f32 = 0.8;
/// Who stands until the path is free wants nobody so far ahead of the outline and beside it, metres.
const FREE_AHEAD_M: f32 = 2.5;
const FREE_BESIDE_M: f32 = 0.5;

/// Who drives.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Policy {
    /// Predictive control, people where they will be.
    Ours,
    /// The same, people where they are.
    Unpredicted,
    /// The dynamic window.
    Dwa,
    /// Ahead along the path while it is free, else it stands.
    Stands,
}

impl Policy {
    /// All of them.
    pub const ALL: [Self; 4] = [Self::Ours, Self::Unpredicted, Self::Dwa, Self::Stands];

    /// In tables.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Ours => "ours",
            Self::Unpredicted => "ours, people standing",
            Self::Dwa => "dynamic window",
            Self::Stands => "stands until free",
        }
    }
}

/// What a driver knows at a moment.
pub struct Known<'a> {
    /// Where the robot is.
    pub pose: Pose2,
    /// How it moves.
    pub twist: Twist2,
    /// People around it.
    pub people: &'a [MovingPerson],
    /// The guard's rules, with the same people.
    pub guard: &'a GuardModel,
}

enum Local {
    Ours(Box<Mppi<Vec<MppiSample>>>),
    Dwa(Box<Dwa<'static>>),
    Stands(PathFollower),
}

/// Steers along a straight path to a goal.
pub struct Driver<'a> {
    planning: &'a LocalPlanning,
    local: Local,
    predicts: bool,
    goal: Point2,
    path: Vec<Waypoint>,
    costs: Vec<u8>,
    revision: u32,
}

impl<'a> Driver<'a> {
    /// From a pose to a goal.
    #[must_use]
    pub fn new(
        planning: &'a LocalPlanning,
        policy: Policy,
        (pose, goal, seed): (Pose2, Point2, u64),
    ) -> Self {
        let path = straight(pose, goal);
        let cells = (SIDE * SIDE) as usize;
        let local = match policy {
            Policy::Ours | Policy::Unpredicted => {
                let samples = vec![MppiSample::default(); planning.samples];
                Local::Ours(Box::new(Mppi::new(planning.mppi, planning.outline.clone(), samples, seed)))
            }
            Policy::Dwa => {
                // Two fields a drive, for as long as the program runs: the planner borrows them.
                let scratch = DwaScratch {
                    path: vec![StepCell::default(); cells].leak(),
                    goal: vec![StepCell::default(); cells].leak(),
                };
                Local::Dwa(Box::new(Dwa::new(planning.dwa, &planning.outline, scratch)))
            }
            Policy::Stands => Local::Stands(PathFollower::new(&path)),
        };
        let predicts = policy != Policy::Unpredicted;
        Self { planning, local, predicts, goal, path, costs: vec![0; cells], revision: 0 }
    }

    /// The request at a moment.
    pub fn request(&mut self, known: &Known<'_>) -> Twist2 {
        let here = Point2::new(known.pose.x_m, known.pose.y_m);
        if self.path.iter().all(|at| at.place_in_map().distance(here) > OFF_M) {
            self.path = straight(known.pose, self.goal);
        }
        if let Local::Stands(follower) = &mut self.local {
            let limits = FollowLimits {
                speed_mps: self.planning.drive.speed_max_mps,
                lost_m: f32::INFINITY,
                ..FollowLimits::DEFAULT
            };
            return match follower.follow(&self.path, known.pose, &limits) {
                FollowState::Drive(twist) if is_free(self.planning, known) => twist,
                _ => Twist2::ZERO,
            };
        }
        if self.predicts {
            return self.plan(known, known.people, known.guard);
        }
        let still = |person: &MovingPerson| MovingPerson {
            velocity_in_map_mps: Point2::default(),
            velocity_deviation_mps: 0.0,
            ..*person
        };
        let people: Vec<MovingPerson> = known.people.iter().map(still).collect();
        let mut guard = known.guard.clone();
        guard.meet(&people, here);
        self.plan(known, &people, &guard)
    }

    fn plan(&mut self, known: &Known<'_>, people: &[MovingPerson], guard: &GuardModel) -> Twist2 {
        let half_m = 0.5 * CELL_M * SIDE as f32;
        let corner = Point2::new(known.pose.x_m - half_m, known.pose.y_m - half_m);
        let sides = GridSides { columns: SIDE, rows: SIDE };
        let Some(geometry) = GridGeometry::with_sides(sides, CELL_M, corner) else { return Twist2::ZERO };
        self.costs.fill(0);
        if matches!(self.local, Local::Dwa(_)) {
            add_people(&geometry, &mut self.costs, people, &self.planning.hills);
        }
        self.revision += 1;
        let Some(costmap) = CostmapView::new(geometry, &self.costs, self.revision) else {
            return Twist2::ZERO;
        };
        let situation = LocalSituation {
            pose_in_map: known.pose,
            twist: known.twist,
            costmap,
            path: &self.path,
            people,
            guard,
            speed_limit_mps: self.planning.drive.speed_max_mps,
        };
        match &mut self.local {
            Local::Ours(planner) => planner.command(&situation).twist,
            Local::Dwa(planner) => planner.command(&situation).twist,
            Local::Stands(_) => Twist2::ZERO,
        }
    }
}

/// A straight path.
fn straight(pose: Pose2, goal: Point2) -> Vec<Waypoint> {
    let (dx_m, dy_m) = (goal.x_m - pose.x_m, goal.y_m - pose.y_m);
    let pieces = (libm::hypotf(dx_m, dy_m) / SPACING_M).ceil().max(1.0);
    let heading_rad = libm::atan2f(dy_m, dx_m);
    let at = |piece: usize| {
        let share = piece as f32 / pieces;
        Pose2::new(pose.x_m + share * dx_m, pose.y_m + share * dy_m, heading_rad)
    };
    (0..=pieces as usize).map(|piece| Waypoint { pose_in_map: at(piece), gear: Gear::Ahead }).collect()
}

/// Nobody stands or walks in the corridor ahead.
fn is_free(planning: &LocalPlanning, known: &Known<'_>) -> bool {
    let corners = planning.outline.corners_in_base();
    let front_m = corners.iter().map(|corner| corner.x_m).fold(0.0, f32::max);
    let side_m = corners.iter().map(|corner| corner.y_m.abs()).fold(0.0, f32::max);
    let base = known.pose.inverse();
    known.people.iter().map(|person| base.transform(person.position_in_map)).all(|place| {
        !(0.0..front_m + FREE_AHEAD_M).contains(&place.x_m) || place.y_m.abs() > side_m + FREE_BESIDE_M
    })
}
