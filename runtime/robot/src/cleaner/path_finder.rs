//! Finds paths for a long robot on the lattice of `floorguard-navigation`, whose memory it holds.

use floorguard_mapping::GridGeometry;
use floorguard_navigation::global::{
    HEADINGS, HeapEntry, Lattice, LatticeCell, LatticeNode, LatticeStorage, LatticeWorld, Pace, Worth,
};
use floorguard_types::geometry::Pose2;
use floorguard_types::motion::{Gear, Waypoint};

/// Length of a straight step, metres: more than a cell, so that it leaves it.
pub const STEP_M: f32 = 0.15;
/// Radius of an arc, metres.
pub const ARC_M: f32 = 0.75;
/// The estimate counts this much more than the path behind: finds good paths sooner than the best one.
pub const HASTE: f32 = 1.3;
/// Poses that a search may look at; the neighbours of the last one are not looked at in part.
const POSES: usize = 150_005;

/// The search with its memory.
pub struct PathFinder {
    lattice: Lattice<Vec<LatticeNode>, Vec<LatticeCell>, Vec<HeapEntry>>,
    path: Vec<Waypoint>,
    kinds: usize,
}

impl PathFinder {
    /// Over a raster.
    pub fn new(raster: GridGeometry, pace: Pace) -> Self {
        let kinds = raster.cell_count() * HEADINGS;
        let storage = LatticeStorage {
            nodes: vec![LatticeNode::default(); POSES],
            cells: vec![LatticeCell::default(); kinds],
            heap: vec![HeapEntry::default(); POSES],
        };
        let path = vec![Waypoint::default(); POSES];
        Self { lattice: Lattice::new(raster, pace, storage), path, kinds }
    }

    /// The speeds that it counts on.
    pub const fn pace(&self) -> &Pace {
        self.lattice.pace()
    }

    /// The path from a pose to the first one that is good enough; `None`: there is none, or the search looked at all the poses
    /// that it may. The start need not be free.
    pub fn find(&mut self, start: Pose2, world: &impl LatticeWorld) -> Option<Vec<Waypoint>> {
        let found = self.lattice.find(start, world, &mut self.path).ok()?;
        self.path.get(..found.waypoints).map(<[Waypoint]>::to_vec)
    }

    /// The path from a pose to the one that a judge likes best, which is shown each pose with the seconds that lead there.
    pub fn find_best(
        &mut self,
        start: Pose2,
        world: &impl LatticeWorld,
        judge: impl FnMut(Pose2, f32) -> Worth,
    ) -> Option<Vec<Waypoint>> {
        let found = self.lattice.find_best(start, world, (judge, &mut self.path)).ok()?;
        self.path.get(..found.waypoints).map(<[Waypoint]>::to_vec)
    }

    /// Every pose that can be reached without driving backwards; calls `visit` once for each place and heading.
    pub fn reach(&mut self, start: Pose2, is_free: impl Fn(Pose2, Gear) -> bool, visit: impl FnMut(Pose2)) {
        let mut stack = vec![Pose2::default(); self.kinds + 1];
        let reached = self.lattice.reach(start, &mut stack, is_free, visit);
        debug_assert!(reached.is_ok(), "the memory is made for the raster");
    }
}

/// What a search asks, as closures.
pub struct Search<S, L, G> {
    /// As [`LatticeWorld::slowness`].
    pub slowness: S,
    /// As [`LatticeWorld::left_s`].
    pub left_s: L,
    /// As [`LatticeWorld::is_goal`].
    pub is_goal: G,
}

impl<S, L, G> LatticeWorld for Search<S, L, G>
where
    S: Fn(Pose2, Gear) -> Option<f32>,
    L: Fn(Pose2) -> Option<f32>,
    G: Fn(Pose2) -> bool,
{
    fn slowness(&self, pose_in_map: Pose2, gear: Gear) -> Option<f32> {
        (self.slowness)(pose_in_map, gear)
    }

    fn left_s(&self, pose_in_map: Pose2) -> Option<f32> {
        (self.left_s)(pose_in_map)
    }

    fn is_goal(&self, pose_in_map: Pose2) -> bool {
        (self.is_goal)(pose_in_map)
    }
}
