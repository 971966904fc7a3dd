//! Maps a building in space out of the sweeps of a spinning lidar: trajectory, surfaces as a cloud, files for other tools.

mod closing;
mod cloud;
mod export;
mod las;
mod mapper;
mod patches;
mod space_map;
mod sweep;

pub use closing::{KeySweep, SmallPoints, SpaceCloser, SpaceCloserConfig, SpaceCloserCounters};
pub use cloud::{CloudPoint, SurfaceCloud};
pub use export::{Colour, colours_of, pcd, ply};
pub use las::{LasError, las};
pub(crate) use mapper::timed_pose;
pub use mapper::{Mapper3, Mapper3Config};
pub use space_map::{Mapper3Counters, SpaceMap, SpaceMapper};
pub use sweep::{SweepRecord, sweep_times};
