//! The path that is driven now, piece by piece: a piece ends where the gear changes.

use floorguard_navigation::global::Plan;
use floorguard_types::geometry::{Point2, Pose2};
use floorguard_types::motion::{Gear, Waypoint};

/// The robot is looked for this far along the path, waypoints.
const LOOK_AHEAD: usize = 40;

/// A path and where on it the robot is.
#[derive(Clone, Debug, Default)]
pub(super) struct Course {
    plan: Option<Plan>,
    path: Vec<Waypoint>,
    /// The waypoint that is nearest to the robot, within the piece.
    at: usize,
    /// First waypoint of the piece, and one past its last.
    piece: (usize, usize),
}

impl Course {
    /// Along a new path.
    pub(super) fn new(plan: Plan, path: Vec<Waypoint>) -> Self {
        let mut course = Self { plan: Some(plan), path, at: 0, piece: (0, 0) };
        course.begin(1);
        course
    }

    /// A follower has ended beside the goal: from a pose straight there, for the local planner. Where that finds no motion, the
    /// robot stands with a reason.
    pub(super) fn end_at(&mut self, (pose_in_map, goal_in_map): (Pose2, Pose2)) {
        let ahead = |pose_in_map| Waypoint { pose_in_map, gear: Gear::Ahead };
        self.path = vec![ahead(pose_in_map), ahead(goal_in_map)];
        self.begin(1);
    }

    fn begin(&mut self, first: usize) {
        let rest = self.path.get(first..).unwrap_or_default();
        let gear = rest.first().map(|at| at.gear);
        let count = rest.iter().take_while(|at| Some(at.gear) == gear).count();
        self.piece = (first, first + count);
        self.at = first.saturating_sub(1);
    }

    /// The plan, unless there is none.
    pub(super) const fn plan(&self) -> Option<&Plan> {
        self.plan.as_ref()
    }

    /// How the piece is driven; `None`: nothing is left.
    pub(super) fn gear(&self) -> Option<Gear> {
        self.path.get(self.piece.0).map(|at| at.gear)
    }

    /// The piece is the last one.
    pub(super) fn is_last(&self) -> bool {
        self.piece.1 >= self.path.len()
    }

    /// The piece was driven to its end.
    pub(super) fn next_piece(&mut self) {
        self.begin(self.piece.1);
    }

    /// The robot is here; gives how far off the path that is, metres.
    pub(super) fn follow(&mut self, pose_in_map: Pose2) -> f32 {
        let here = Point2::new(pose_in_map.x_m, pose_in_map.y_m);
        let end = self.piece.1.min(self.at + LOOK_AHEAD);
        let ahead = self.path.get(self.at..end).unwrap_or_default();
        let distance_m = |at: &Waypoint| at.place_in_map().distance(here);
        let nearest = ahead.iter().enumerate().min_by(|a, b| distance_m(a.1).total_cmp(&distance_m(b.1)));
        let (offset, off_m) = nearest.map_or((0, 0.0), |(offset, at)| (offset, distance_m(at)));
        self.at += offset;
        off_m
    }

    /// What is left of the piece, from the robot on.
    pub(super) fn piece(&self) -> &[Waypoint] {
        self.path.get(self.at..self.piece.1).unwrap_or_default()
    }

    /// The whole piece from where it begins.
    pub(super) fn whole_piece(&self) -> &[Waypoint] {
        self.path.get(self.piece.0.saturating_sub(1)..self.piece.1).unwrap_or_default()
    }

    /// Everything that is left, from the robot on.
    pub(super) fn rest(&self) -> &[Waypoint] {
        self.path.get(self.at..).unwrap_or_default()
    }

    /// Along the path from here to its end, metres.
    pub(super) fn left_m(&self) -> f32 {
        self.rest().windows(2).map(|pair| pair[0].place_in_map().distance(pair[1].place_in_map())).sum()
    }
}
