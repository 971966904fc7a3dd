//! Finds a path for a long robot: straight on, on arcs, on the spot, and backwards.
//!
//! Best-first search over place and heading (hybrid A*, Dolgov and others 2008: poses stay continuous; a raster of places and
//! 16 headings decides which are alike). Storage is the caller's: a node for each pose looked at, a record for each place and
//! heading, and the open list.

use floorguard_mapping::{GRID_CELLS_MAX, GridGeometry};
use floorguard_types::geometry::{Point2, Pose2};
use floorguard_types::motion::{Gear, Waypoint};
use floorguard_types::number::{
    exact_usize, saturating_i32, saturating_u32, truncating_i32, truncating_u32, truncating_usize,
};

use super::contract::PlanFailure;
use super::lattice_heap::{HeapEntry, pop, push};
use super::lattice_motions::{HEADINGS, MOTIONS, Motion, Pace, TURN_RAD, motions};

/// Costs are compared in units of 0.1 ms.
const UNITS_PER_S: f32 = 1.0e4;

/// What the search asks.
pub trait LatticeWorld {
    /// Factor of the time against open floor a motion to this pose takes; `None`: the robot cannot be there.
    fn slowness(&self, pose_in_map: Pose2, gear: Gear) -> Option<f32>;
    /// Time from this pose to the goal, seconds, estimated; `None`: the goal cannot be reached from there.
    fn left_s(&self, pose_in_map: Pose2) -> Option<f32>;
    /// This pose is good enough.
    fn is_goal(&self, pose_in_map: Pose2) -> bool;
}

/// What a judge says of a pose.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Worth {
    /// It is no better than one before.
    Less,
    /// It is the best one so far.
    Best,
    /// It is the best one, and no other need be shown.
    Chosen,
    /// It is no better, and none that could be shown is.
    Enough,
}

/// A pose that the search looked at.
#[derive(Clone, Copy, Debug, Default)]
pub struct LatticeNode {
    pose: Pose2,
    gear: Gear,
    parent: u32,
    cost_s: f32,
}

/// The best cost of a place and heading, and the search that found it.
#[derive(Clone, Copy, Debug, Default)]
pub struct LatticeCell {
    cost_s: f32,
    round: u32,
}

/// The memory of a search.
#[derive(Clone, Copy, Debug)]
pub struct LatticeStorage<N, C, H> {
    /// As many poses as a search may look at.
    pub nodes: N,
    /// One record for each cell and heading of the raster.
    pub cells: C,
    /// As many entries as nodes.
    pub heap: H,
}

/// The search with its memory, which [`LatticeStorage`] describes.
#[derive(Clone, Debug)]
pub struct Lattice<N, C, H> {
    raster: GridGeometry,
    motions: [Motion; MOTIONS],
    pace: Pace,
    nodes: N,
    cells: C,
    heap: H,
    round: u32,
    used: usize,
    waiting: usize,
}

impl<N, C, H> Lattice<N, C, H>
where
    N: AsRef<[LatticeNode]> + AsMut<[LatticeNode]>,
    C: AsRef<[LatticeCell]> + AsMut<[LatticeCell]>,
    H: AsRef<[HeapEntry]> + AsMut<[HeapEntry]>,
{
    /// Over a raster, which need not be that of the costmap: two cells to a straight step are enough.
    #[must_use]
    pub fn new(raster: GridGeometry, pace: Pace, storage: LatticeStorage<N, C, H>) -> Self {
        let motions = motions(&pace);
        let LatticeStorage { nodes, cells, heap } = storage;
        Self { raster, motions, pace, nodes, cells, heap, round: 0, used: 0, waiting: 0 }
    }

    /// The speeds that it counts on.
    #[must_use]
    pub const fn pace(&self) -> &Pace {
        &self.pace
    }

    /// How many poses the last search looked at.
    #[must_use]
    pub const fn examined(&self) -> usize {
        self.used
    }

    /// A path from a pose to the first one that is good enough; gives how many waypoints were written, and its seconds. The
    /// start need not be free.
    ///
    /// # Errors
    /// [`PlanFailure::Unreachable`], [`PlanFailure::PathTooLong`], or [`PlanFailure::OutOfRoom`].
    pub fn find(
        &mut self,
        start_in_map: Pose2,
        world: &impl LatticeWorld,
        path: &mut [Waypoint],
    ) -> Result<LatticePath, PlanFailure> {
        let judge = |pose: Pose2, _: f32| if world.is_goal(pose) { Worth::Chosen } else { Worth::Less };
        self.find_best(start_in_map, world, (judge, path))
    }

    /// A path from a pose to the one that a judge likes best: it is shown poses with the seconds that lead to them, the sooner ones
    /// first if [`LatticeWorld::left_s`] is 0 everywhere, until it has chosen or all were shown. Where the storage ends before, the best
    /// one so far counts. Goals of the world play no part.
    ///
    /// # Errors
    /// As [`Self::find`]; [`PlanFailure::OutOfRoom`] only before any pose was liked.
    pub fn find_best(
        &mut self,
        start_in_map: Pose2,
        world: &impl LatticeWorld,
        (mut judge, path): (impl FnMut(Pose2, f32) -> Worth, &mut [Waypoint]),
    ) -> Result<LatticePath, PlanFailure> {
        if self.cells.as_ref().len() < self.kinds() {
            return Err(PlanFailure::OutOfRoom);
        }
        self.kind(start_in_map).ok_or(PlanFailure::StartBlocked)?;
        self.begin();
        let start = LatticeNode { pose: start_in_map, gear: Gear::Ahead, parent: u32::MAX, cost_s: 0.0 };
        self.open(start, world.left_s(start_in_map).unwrap_or(0.0))?;
        let (mut best, mut failure) = (None, PlanFailure::OutOfRoom);
        for _ in 0..self.nodes.as_ref().len().max(1) {
            let Some(entry) = pop(self.heap.as_mut(), self.waiting) else {
                failure = PlanFailure::Unreachable;
                break;
            };
            debug_assert!(self.waiting <= self.used, "every pose waits once");
            self.waiting = self.waiting.saturating_sub(1);
            let Some(node) = self.nodes.as_ref().get(exact_usize(entry.node)).copied() else { continue };
            let is_outdated = self.kind(node.pose).is_none_or(|kind| self.best_s(kind) < node.cost_s);
            if is_outdated {
                continue;
            }
            let worth = judge(node.pose, node.cost_s);
            if matches!(worth, Worth::Best | Worth::Chosen) {
                best = Some((entry.node, node.cost_s));
            }
            if matches!(worth, Worth::Chosen | Worth::Enough) {
                failure = PlanFailure::Unreachable;
                break;
            }
            if let Err(full) = self.expand(entry.node, node, world) {
                failure = full;
                break;
            }
        }
        let (number, time_s) = best.ok_or(failure)?;
        let waypoints = self.path_to(number, path)?;
        Ok(LatticePath { waypoints, time_s })
    }

    /// Visits poses that can be reached from a start without driving backwards, one for each place and heading; the start too,
    /// which need not be free. `stack` holds one pose for each cell and heading of the raster, and the start.
    ///
    /// # Errors
    /// [`PlanFailure::OutOfRoom`]: the storage or the stack is too small; nothing was visited.
    pub fn reach(
        &mut self,
        start_in_map: Pose2,
        stack: &mut [Pose2],
        is_free: impl Fn(Pose2, Gear) -> bool,
        mut visit: impl FnMut(Pose2),
    ) -> Result<(), PlanFailure> {
        let kinds = self.kinds();
        if self.cells.as_ref().len() < kinds || stack.len() <= kinds {
            return Err(PlanFailure::OutOfRoom);
        }
        self.begin();
        let mut waiting = 0_usize;
        put(stack, &mut waiting, start_in_map);
        // Each place and heading is put on the stack once, and the start.
        for _ in 0..stack.len() {
            let Some(last) = waiting.checked_sub(1) else { break };
            let Some(pose) = stack.get(last).copied() else { break };
            waiting = last;
            visit(pose);
            for motion in self.motions.iter().filter(|motion| motion.gear != Gear::Back) {
                let next = pose.compose(motion.by);
                let Some(kind) = self.kind(next) else { continue };
                if self.best_s(kind) < f32::INFINITY || !is_free(next, motion.gear) {
                    continue;
                }
                if let Some(cell) = self.cells.as_mut().get_mut(kind) {
                    *cell = LatticeCell { cost_s: 0.0, round: self.round };
                }
                put(stack, &mut waiting, next);
            }
        }
        Ok(())
    }

    /// How many places and headings are kept apart.
    fn kinds(&self) -> usize {
        self.raster.cell_count().saturating_mul(HEADINGS)
    }

    fn begin(&mut self) {
        self.round = self.round.wrapping_add(1);
        if self.round == 0 {
            self.cells.as_mut().fill(LatticeCell::default());
            self.round = 1;
        }
        (self.used, self.waiting) = (0, 0);
    }

    fn expand(
        &mut self,
        number: u32,
        node: LatticeNode,
        world: &impl LatticeWorld,
    ) -> Result<(), PlanFailure> {
        if self.nodes.as_ref().len().saturating_sub(self.used) < MOTIONS {
            return Err(PlanFailure::OutOfRoom);
        }
        for motion in self.motions {
            let next = node.pose.compose(motion.by);
            let change_s = if motion.gear == node.gear { 0.0 } else { self.pace.change_s };
            let Some(kind) = self.kind(next) else { continue };
            if self.best_s(kind) <= node.cost_s + motion.costs_s + change_s {
                continue;
            }
            let Some(slowness) = world.slowness(next, motion.gear) else { continue };
            let cost_s = node.cost_s + motion.costs_s * slowness.max(1.0) + change_s;
            if self.best_s(kind) <= cost_s {
                continue;
            }
            debug_assert!(cost_s >= node.cost_s, "no motion gives time back");
            let Some(left_s) = world.left_s(next) else { continue };
            self.open(LatticeNode { pose: next, gear: motion.gear, parent: number, cost_s }, left_s)?;
            if let Some(cell) = self.cells.as_mut().get_mut(kind) {
                *cell = LatticeCell { cost_s, round: self.round };
            }
        }
        Ok(())
    }

    fn open(&mut self, node: LatticeNode, left_s: f32) -> Result<(), PlanFailure> {
        *self.nodes.as_mut().get_mut(self.used).ok_or(PlanFailure::OutOfRoom)? = node;
        let urgency = saturating_u32((node.cost_s + self.pace.haste * left_s) * UNITS_PER_S);
        let entry = HeapEntry { urgency, node: truncating_u32(self.used) };
        self.waiting = push(self.heap.as_mut(), self.waiting, entry).ok_or(PlanFailure::OutOfRoom)?;
        self.used = self.used.saturating_add(1);
        Ok(())
    }

    /// Place and heading as one number.
    fn kind(&self, pose: Pose2) -> Option<usize> {
        let cell = self.raster.cell_at(Point2::new(pose.x_m, pose.y_m))?;
        let heading = saturating_i32(libm::roundf(pose.heading_rad / TURN_RAD));
        let heading = truncating_usize(heading.rem_euclid(truncating_i32(HEADINGS)));
        Some(cell.saturating_mul(HEADINGS).saturating_add(heading))
    }

    fn best_s(&self, kind: usize) -> f32 {
        let cell = self.cells.as_ref().get(kind).filter(|cell| cell.round == self.round);
        cell.map_or(f32::INFINITY, |cell| cell.cost_s)
    }

    /// Writes the waypoints up to a node.
    fn path_to(&self, number: u32, path: &mut [Waypoint]) -> Result<usize, PlanFailure> {
        let nodes = self.nodes.as_ref();
        let before = |at: u32| nodes.get(exact_usize(at)).map_or(u32::MAX, |node| node.parent);
        let chain = || {
            core::iter::successors(Some(number), |&at| Some(before(at)).filter(|&at| at != u32::MAX))
                .take(GRID_CELLS_MAX)
        };
        let count = chain().take(self.used).count();
        let path = path.get_mut(..count).ok_or(PlanFailure::PathTooLong(count))?;
        for (slot, at) in path.iter_mut().rev().zip(chain()) {
            if let Some(node) = nodes.get(exact_usize(at)) {
                *slot = Waypoint { pose_in_map: node.pose, gear: node.gear };
            }
        }
        Ok(count)
    }
}

/// A path of the lattice.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LatticePath {
    /// How many waypoints were written.
    pub waypoints: usize,
    /// How long it takes, seconds.
    pub time_s: f32,
}

/// Onto a stack that has room for it.
fn put(stack: &mut [Pose2], waiting: &mut usize, pose: Pose2) {
    if let Some(slot) = stack.get_mut(*waiting) {
        *slot = pose;
        *waiting = waiting.saturating_add(1);
    }
}
