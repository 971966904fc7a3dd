//! What a sweep needs to be interpreted, and what it yielded.

use crate::clusters::Cluster;
use crate::tracking::TrackOf;
use floorguard_types::geometry::{Pose2, Transform3, Twist2};
use floorguard_types::profile::{Native, Profile};

/// Where the sensor was while it measured.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SweepContext {
    /// The lidar on the robot; its z is the height above the floor.
    pub sensor_in_base: Transform3,
    /// The robot's speed during the sweep.
    pub twist: Twist2,
    /// The robot at the end of the sweep, in the fixed frame of the tracks.
    pub base_in_odom: Pose2,
}

/// What happened to the returns of a sweep.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct PeopleCounters {
    /// Returns in the sweep.
    pub points: u32,
    /// Returns that are floor.
    pub floor_points: u32,
    /// Clusters found.
    pub clusters: u32,
    /// Of them those that move by themselves.
    pub moving_clusters: u32,
    /// Clusters that may be people.
    pub candidates: u32,
    /// Clusters dropped because the list was full.
    pub dropped_clusters: u32,
    /// Candidates dropped because the list was full.
    pub dropped_candidates: u32,
    /// Columns that were not measured.
    pub unknown_columns: u32,
}

impl PeopleCounters {
    pub(super) const ZERO: Self = Self {
        points: 0,
        floor_points: 0,
        clusters: 0,
        moving_clusters: 0,
        candidates: 0,
        dropped_clusters: 0,
        dropped_candidates: 0,
        unknown_columns: 0,
    };
}

/// What a sweep yielded.
#[derive(Clone, Copy, Debug)]
pub struct PeopleOutputOf<'a, P: Profile> {
    /// Clusters of this sweep, in the robot's frame.
    pub clusters: &'a [Cluster],
    /// People and what looks like them, in the fixed frame.
    pub tracks: &'a [TrackOf<P>],
    /// Where the returns went.
    pub counters: PeopleCounters,
}

/// What a sweep yielded, in the memory of the target.
pub type PeopleOutput<'a> = PeopleOutputOf<'a, Native>;
