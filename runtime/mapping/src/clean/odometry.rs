//! The track of a lidar by its own sweeps, for recordings without poses.

use floorguard_mapping::lidar_odometry::{FloorPrior, MotionAid, SweepReturn};

use super::sweep::RawSweep;
use super::track::{Track, TrackError};
use crate::lidar3d::{Mapper3, Mapper3Config, Mapper3Counters, SweepRecord};

/// Matches sweep after sweep; the first pose is the origin of the map.
pub struct SweepTracker {
    mapper: Mapper3,
    is_unsolvable: bool,
}

impl SweepTracker {
    /// With the standard settings; `level_floor` holds height, roll and pitch of a lidar that stands upright.
    #[must_use]
    pub fn new(level_floor: bool) -> Self {
        let mut config = Mapper3Config::default();
        config.odometry.floor = level_floor.then(FloorPrior::default);
        Self { mapper: Mapper3::new(config), is_unsolvable: false }
    }

    /// Enters a sweep; one that is not later than the one before, or has no duration, is counted and left out.
    pub fn push(&mut self, sweep: &RawSweep) {
        let duration_s = sweep.duration_s();
        let per_s = if duration_s > 0.0 { (1.0 / duration_s) as f32 } else { 0.0 };
        let returns = sweep.returns.iter().map(|each| {
            SweepReturn::new(each.point_in_sensor, (each.offset_s * per_s).clamp(0.0, 1.0), each.ring)
        });
        let record = SweepRecord {
            end_s: sweep.start_s + duration_s,
            duration_s,
            returns: returns.collect(),
            reflectivity: Vec::new(),
        };
        self.is_unsolvable |= self.mapper.push(record, &MotionAid::default()).is_err();
    }

    /// What became of the sweeps.
    #[must_use]
    pub const fn counters(&self) -> Mapper3Counters {
        self.mapper.counters
    }

    /// The track, with all loops closed.
    ///
    /// # Errors
    /// No sweep could be used, or the loops contradict each other.
    pub fn finish(mut self) -> Result<Track, TrackError> {
        self.is_unsolvable |= self.mapper.finish().is_err();
        if self.is_unsolvable {
            return Err(TrackError::Unsolvable);
        }
        Track::new(self.mapper.trajectory())
    }
}
