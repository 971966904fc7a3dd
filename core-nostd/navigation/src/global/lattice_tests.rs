//! Paths of the lattice round a wall, and what can be reached.

use super::lattice::*;
use super::{HEADINGS, HeapEntry, Pace, PlanFailure};
use floorguard_mapping::GridGeometry;
use floorguard_types::geometry::{Point2, Pose2};
use floorguard_types::motion::{Gear, Waypoint};
use std::vec;

const PACE: Pace = Pace {
    speed_mps: 0.5,
    turn_radps: 0.6,
    reverse_mps: 0.2,
    change_s: 1.0,
    step_m: 0.15,
    arc_m: 0.75,
    haste: 1.3,
};
const POSES: usize = 100_000;

/// A floor with a wall that has one gap.
struct Walled {
    goal: Point2,
    guesses: bool,
}

fn place(pose: Pose2) -> Point2 {
    Point2::new(pose.x_m, pose.y_m)
}

fn is_free(pose: Pose2, _: Gear) -> bool {
    let inside = pose.x_m > 0.5 && pose.x_m < 7.5 && pose.y_m > 0.5 && pose.y_m < 5.5;
    inside && ((pose.x_m - 4.0).abs() > 0.6 || pose.y_m > 4.0)
}

impl LatticeWorld for Walled {
    fn slowness(&self, pose_in_map: Pose2, gear: Gear) -> Option<f32> {
        is_free(pose_in_map, gear).then_some(1.0)
    }

    fn left_s(&self, pose_in_map: Pose2) -> Option<f32> {
        let left_s = place(pose_in_map).distance(self.goal) / PACE.speed_mps;
        Some(if self.guesses { left_s } else { 0.0 })
    }

    fn is_goal(&self, pose_in_map: Pose2) -> bool {
        place(pose_in_map).distance(self.goal) < 0.2
    }
}

#[test]
fn path_uses_gap_not_wall() {
    let raster = GridGeometry::new(80, 60, 0.1, Point2::default()).unwrap();
    let kinds = raster.cell_count() * HEADINGS;
    let storage = LatticeStorage {
        nodes: vec![LatticeNode::default(); POSES],
        cells: vec![LatticeCell::default(); kinds],
        heap: vec![HeapEntry::default(); POSES],
    };
    let mut lattice = Lattice::new(raster, PACE, storage);
    let start = Pose2::new(1.0, 1.0, 0.0);
    let mut path = vec![Waypoint::default(); 500];
    let behind_the_wall = Walled { goal: Point2::new(7.0, 1.0), guesses: true };
    let found = lattice.find(start, &behind_the_wall, &mut path).unwrap();
    let path = &path[..found.waypoints];
    assert!(path.iter().all(|at| is_free(at.pose_in_map, at.gear)));
    assert!(path.iter().any(|at| at.pose_in_map.y_m > 4.0));
    assert!(path.windows(2).all(|pair| pair[0].place_in_map().distance(pair[1].place_in_map()) < 0.4));
    let nowhere = Walled { goal: Point2::new(9.0, 9.0), guesses: false };
    assert_eq!(lattice.find(start, &nowhere, &mut []), Err(PlanFailure::Unreachable));
    let mut reached = 0;
    let visit = |pose: Pose2| {
        assert!(is_free(pose, Gear::Ahead));
        reached += 1;
    };
    lattice.reach(start, &mut vec![Pose2::default(); kinds + 1], is_free, visit).unwrap();
    assert!(reached > 10_000, "{reached}");
    let too_small = lattice.reach(start, &mut vec![Pose2::default(); kinds], is_free, |_| {});
    assert_eq!(too_small, Err(PlanFailure::OutOfRoom));
}
