//! Clusters: from a sweep to what stands on the floor, without a judgement what it is.
//!
//! Ground → clusters, on the range image: neighbourhood is index arithmetic, no tree is built. Source: book, People.

mod cluster;
mod clusterer;
mod floor_height;
mod ground;
mod labels;
mod projection;
mod returns;
pub mod ring_clusters;
mod upside_down;

pub use cluster::{Cluster, ClusterLimits};
pub(crate) use clusterer::{Clusterer, Obstacles, rings_of};
pub use floor_height::FloorHeight;
pub(crate) use ground::FloorLimits;
pub use ground::FloorMask;
pub(crate) use labels::NONE;
pub use projection::RingAngles;
pub(crate) use projection::{ColumnFrame, RingProfile, SweepFrame};
pub use returns::{SeenReturn, returns_in_base};
pub use upside_down::{hangs, turn_over, turned_over_mounting};
