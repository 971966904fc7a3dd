//! What comes of a drive, whichever way it was mapped.

use floorguard_mapping::lidar_odometry::MotionAid;

use super::closing::SpaceCloserCounters;
use super::cloud::SurfaceCloud;
use super::sweep::SweepRecord;
use crate::metrics::TimedPose;
use crate::pose_graph::Unsolvable;

/// What became of the sweeps.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Mapper3Counters {
    /// Taken.
    pub sweeps: u64,
    /// Left out: not later than the one before.
    pub not_later: u64,
    /// Returns that matched too little: the pose is a prediction.
    pub blind: u64,
    /// One direction was held by the prediction alone.
    pub held: u64,
    /// Entered into the map.
    pub mapped: u64,
}

/// A map in space.
#[derive(Clone, Debug)]
pub struct SpaceMap {
    /// Pose of the sensor at the end of each sweep, in the frame of the first one.
    pub trajectory: Vec<TimedPose>,
    /// The surfaces.
    pub cloud: SurfaceCloud,
    /// What became of the sweeps.
    pub counters: Mapper3Counters,
    /// Cubes of the map of planes, and how many it gave up.
    pub cubes: [u32; 2],
    /// How far the place may be off by sweeps without information about one direction, before loops: one standard deviation, metres. `None`
    /// where the method says nothing about it.
    pub held_deviation_m: Option<f64>,
    /// Places that were recognised.
    pub loops: SpaceCloserCounters,
    /// Those of them that count in the graph.
    pub loops_believed: usize,
}

/// A way of mapping.
pub trait SpaceMapper {
    /// Takes a sweep; one that is not later than the one before is counted and left out.
    ///
    /// # Errors
    /// A loop was found, and the graph cannot be solved.
    fn take(&mut self, sweep: SweepRecord, aid: &MotionAid) -> Result<(), Unsolvable>;

    /// The map, after the last sweep.
    ///
    /// # Errors
    /// The graph cannot be solved.
    fn conclude(&mut self) -> Result<SpaceMap, Unsolvable>;
}
