//! Finds a path for a long robot: straight on, on arcs, on the spot, and backwards.
//!
//! Best-first search over place and heading (hybrid A*: the poses stay continuous, a raster of cells and 16 headings
//! tells which are alike). The estimate of what is left is the path of a point over the raster around obstacles.

use std::cmp::Reverse;
use std::collections::BinaryHeap;

use floorguard_mapping::GridGeometry;
use floorguard_types::geometry::{Pose2, wrap_angle};
pub use floorguard_types::motion::Gear;

/// Heading bins of the search.
pub const HEADINGS: usize = 16;
const TURN_RAD: f32 = std::f32::consts::TAU / HEADINGS as f32;
/// Length of a straight step, metres: more than a cell, so that it leaves it.
pub const STEP_M: f32 = 0.15;
/// Radius of an arc, metres.
const ARC_M: f32 = 0.75;
/// Poses that a search may look at.
const POSES_MAX: usize = 150_000;
/// The estimate counts this much more than the path behind: finds good paths sooner than the best one.
const HASTE: f32 = 1.3;

/// A pose on a path.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Waypoint {
    /// In the map frame.
    pub pose: Pose2,
    /// How it is reached.
    pub gear: Gear,
}

/// A motion: how it moves in the robot's frame, what it costs in seconds, and its gear.
struct Motion {
    by: Pose2,
    costs_s: f32,
    gear: Gear,
}

/// Speeds that the costs are made of.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pace {
    /// Forward, m/s.
    pub speed_mps: f32,
    /// On the spot, rad/s.
    pub turn_radps: f32,
    /// Backwards, m/s.
    pub reverse_mps: f32,
    /// What it takes to turn the front wheel across or back, seconds.
    pub change_s: f32,
}

struct Node {
    pose: Pose2,
    gear: Gear,
    parent: u32,
    cost_s: f32,
}

/// Search with its memory.
pub struct Lattice {
    raster: GridGeometry,
    motions: [Motion; 6],
    pace: Pace,
    nodes: Vec<Node>,
    /// Best cost and round of every kind of pose.
    best: Vec<(f32, u32)>,
    round: u32,
}

impl Lattice {
    /// Over a raster.
    pub fn new(raster: GridGeometry, pace: Pace) -> Self {
        let chord_m = 2.0 * ARC_M * (TURN_RAD / 2.0).sin();
        let arc = |sign: f32| {
            let half = sign * TURN_RAD / 2.0;
            Motion {
                by: Pose2::new(chord_m * half.cos(), chord_m * half.sin(), sign * TURN_RAD),
                costs_s: ARC_M * TURN_RAD / (0.8 * pace.speed_mps).min(pace.turn_radps * ARC_M),
                gear: Gear::Ahead,
            }
        };
        let spin = |sign: f32| Motion {
            by: Pose2::new(0.0, 0.0, sign * TURN_RAD),
            costs_s: TURN_RAD / pace.turn_radps,
            gear: Gear::Spin,
        };
        let straight = |path_m: f32, speed_mps: f32, gear| Motion {
            by: Pose2::new(path_m, 0.0, 0.0),
            costs_s: path_m.abs() / speed_mps,
            gear,
        };
        let motions = [
            straight(STEP_M, pace.speed_mps, Gear::Ahead),
            arc(1.0),
            arc(-1.0),
            spin(1.0),
            spin(-1.0),
            straight(-STEP_M, pace.reverse_mps, Gear::Back),
        ];
        let kinds = raster.cell_count() * HEADINGS;
        Self { raster, motions, pace, nodes: Vec::new(), best: vec![(0.0, 0); kinds], round: 0 }
    }

    /// The speeds that it counts on.
    pub const fn pace(&self) -> Pace {
        self.pace
    }

    fn kind(&self, pose: Pose2) -> Option<usize> {
        let cell = self.raster.cell_at(floorguard_types::geometry::Point2::new(pose.x_m, pose.y_m))?;
        let heading = (pose.heading_rad / TURN_RAD).round() as i32;
        Some(cell * HEADINGS + heading.rem_euclid(HEADINGS as i32) as usize)
    }

    /// The path from a pose to the first one that is good enough. `slowness(pose, gear)` tells where the robot may be,
    /// and how many times as long as in the open it takes there; `left_s(pose)` estimates the time that is left,
    /// `None`: no path leads on from there. The start need not be free.
    pub fn find(
        &mut self,
        start: Pose2,
        (slowness, left_s): (impl Fn(Pose2, Gear) -> Option<f32>, impl Fn(Pose2) -> Option<f32>),
        is_enough: impl Fn(Pose2) -> bool,
    ) -> Option<Vec<Waypoint>> {
        self.round += 1;
        self.nodes.clear();
        let mut open: BinaryHeap<(Reverse<u32>, Reverse<u32>)> = BinaryHeap::new();
        let urgency = |cost_s: f32, left_s: f32| Reverse(((cost_s + HASTE * left_s) * 1.0e4) as u32);
        self.nodes.push(Node { pose: start, gear: Gear::Ahead, parent: u32::MAX, cost_s: 0.0 });
        open.push((urgency(0.0, left_s(start).unwrap_or(0.0)), Reverse(0)));
        while let Some((_, Reverse(index))) = open.pop() {
            let (pose, gear, cost_s) = {
                let node = &self.nodes[index as usize];
                (node.pose, node.gear, node.cost_s)
            };
            let Some(kind) = self.kind(pose) else { continue };
            if self.best[kind].1 == self.round && self.best[kind].0 < cost_s {
                continue;
            }
            if is_enough(pose) {
                return Some(self.path_to(index));
            }
            if self.nodes.len() >= POSES_MAX {
                return None;
            }
            for motion in 0..self.motions.len() {
                let Motion { by, costs_s, gear: next_gear } = &self.motions[motion];
                let (next, next_gear) = (pose.compose(*by), *next_gear);
                let change_s = if next_gear == gear { 0.0 } else { self.pace.change_s };
                let least_s = cost_s + costs_s + change_s;
                let Some(kind) = self.kind(next) else { continue };
                let best_s = if self.best[kind].1 == self.round { self.best[kind].0 } else { f32::INFINITY };
                if best_s <= least_s {
                    continue;
                }
                let Some(slowness) = slowness(next, next_gear) else { continue };
                let next_s = cost_s + costs_s * slowness + change_s;
                if best_s <= next_s {
                    continue;
                }
                let Some(left_s) = left_s(next) else { continue };
                self.best[kind] = (next_s, self.round);
                let number = self.nodes.len() as u32;
                self.nodes.push(Node { pose: next, gear: next_gear, parent: index, cost_s: next_s });
                open.push((urgency(next_s, left_s), Reverse(number)));
            }
        }
        None
    }

    /// Every pose that can be reached without driving backwards; calls `visit` once for each kind of pose.
    pub fn reach(
        &mut self,
        start: Pose2,
        is_free: impl Fn(Pose2, Gear) -> bool,
        mut visit: impl FnMut(Pose2),
    ) {
        self.round += 1;
        let mut open = vec![start];
        while let Some(pose) = open.pop() {
            visit(pose);
            for motion in self.motions.iter().take(5) {
                let next = pose.compose(motion.by);
                let Some(kind) = self.kind(next) else { continue };
                if self.best[kind].1 == self.round || !is_free(next, motion.gear) {
                    continue;
                }
                self.best[kind] = (0.0, self.round);
                open.push(next);
            }
        }
    }

    fn path_to(&self, index: u32) -> Vec<Waypoint> {
        let mut path = Vec::new();
        let mut at = index;
        while let Some(node) = self.nodes.get(at as usize) {
            let pose = Pose2 { heading_rad: wrap_angle(node.pose.heading_rad), ..node.pose };
            path.push(Waypoint { pose, gear: node.gear });
            at = node.parent;
        }
        path.reverse();
        path
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use floorguard_types::geometry::Point2;

    const PACE: Pace = Pace { speed_mps: 0.5, turn_radps: 0.6, reverse_mps: 0.2, change_s: 1.0 };

    /// A wall with one gap between the robot and the place behind it.
    #[test]
    fn path_uses_gap_not_wall() {
        let raster = GridGeometry::new(80, 60, 0.1, Point2::default()).unwrap();
        let mut lattice = Lattice::new(raster, PACE);
        let is_free = |pose: Pose2, _| {
            let inside = pose.x_m > 0.5 && pose.x_m < 7.5 && pose.y_m > 0.5 && pose.y_m < 5.5;
            inside && ((pose.x_m - 4.0).abs() > 0.6 || pose.y_m > 4.0)
        };
        let goal = Point2::new(7.0, 1.0);
        let place = |pose: Pose2| Point2::new(pose.x_m, pose.y_m);
        let left_s = |pose: Pose2| Some(place(pose).distance(goal) / PACE.speed_mps);
        let start = Pose2::new(1.0, 1.0, 0.0);
        let slowness = |pose: Pose2, gear| is_free(pose, gear).then_some(1.0);
        let path = lattice.find(start, (slowness, left_s), |pose| place(pose).distance(goal) < 0.2).unwrap();
        assert!(path.iter().all(|at| is_free(at.pose, at.gear)));
        assert!(path.iter().any(|at| at.pose.y_m > 4.0));
        assert!(path.windows(2).all(|pair| place(pair[0].pose).distance(place(pair[1].pose)) < 0.4));
        let nowhere = |pose: Pose2| place(pose).distance(Point2::new(9.0, 9.0)) < 0.2;
        assert!(lattice.find(start, (slowness, |_| Some(0.0)), nowhere).is_none());
        let mut reached = 0;
        lattice.reach(start, is_free, |pose| {
            assert!(is_free(pose, Gear::Ahead));
            reached += 1;
        });
        assert!(reached > 10_000, "{reached}");
    }
}
