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

fn lattice(poses: usize) -> Lattice<vec::Vec<LatticeNode>, vec::Vec<LatticeCell>, vec::Vec<HeapEntry>> {
    let raster = GridGeometry::new(80, 60, 0.1, Point2::default()).unwrap();
    let storage = LatticeStorage {
        nodes: vec![LatticeNode::default(); poses],
        cells: vec![LatticeCell::default(); raster.cell_count() * HEADINGS],
        heap: vec![HeapEntry::default(); poses],
    };
    Lattice::new(raster, PACE, storage)
}

/// Likes a pose the more the nearer it is to a place; gives what it was shown.
fn nearest(
    poses: usize,
    (liked, enough): (Point2, usize),
) -> (Result<LatticePath, PlanFailure>, vec::Vec<Waypoint>, vec::Vec<f32>) {
    let anywhere = Walled { goal: Point2::new(1.2, 1.0), guesses: false };
    let (mut shown_s, mut least_m) = (vec::Vec::new(), f32::INFINITY);
    let judge = |pose: Pose2, way_s: f32| {
        if shown_s.len() >= enough {
            return Worth::Enough;
        }
        shown_s.push(way_s);
        let distance_m = place(pose).distance(liked);
        if distance_m >= least_m {
            return Worth::Less;
        }
        least_m = distance_m;
        Worth::Best
    };
    let mut path = vec![Waypoint::default(); 500];
    let start = Pose2::new(1.0, 1.0, 0.0);
    let found = lattice(poses).find_best(start, &anywhere, (judge, &mut path));
    path.truncate(found.map_or(0, |found| found.waypoints));
    (found, path, shown_s)
}

/// The goal of the world plays no part, and what was shown first took no longer.
#[test]
fn best_pose_is_found_behind_wall() {
    let liked = Point2::new(6.8, 1.2);
    let (found, path, shown_s) = nearest(POSES, (liked, usize::MAX));
    assert!(path.last().unwrap().place_in_map().distance(liked) < 0.15, "{:?}", path.last());
    assert!(path.iter().any(|at| at.pose_in_map.y_m > 4.0), "through the gap");
    assert!(shown_s.windows(2).all(|pair| pair[1] >= pair[0] - 1.0e-4), "to the unit of the queue");
    assert!(shown_s.contains(&found.unwrap().time_s));
    assert!(found.unwrap().time_s > 12.0, "{found:?}");
}

#[test]
fn best_so_far_counts_when_search_ends() {
    let liked = Point2::new(6.8, 1.2);
    let end =
        |poses: usize, enough: usize| nearest(poses, (liked, enough)).1.last().map(|at| at.place_in_map());
    let (whole, full, enough) = (end(POSES, usize::MAX), end(3_000, usize::MAX), end(POSES, 500));
    let left_m = [whole, full, enough].map(|at| at.unwrap().distance(liked));
    assert!(left_m[0] < 0.15 && left_m[1] > 1.0 && left_m[2] > left_m[1], "{left_m:?}");
    assert_eq!(nearest(POSES, (liked, 0)).0, Err(PlanFailure::Unreachable), "nothing was liked");
    assert_eq!(nearest(3, (liked, 0)).0, Err(PlanFailure::Unreachable));
}
