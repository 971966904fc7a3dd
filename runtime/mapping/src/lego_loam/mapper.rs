//! A drive mapped by LeGO-LOAM: trajectory and cloud.

use floorguard_mapping::lidar_odometry::{MotionAid, Pose3};

use super::config::LegoLoamConfig;
use super::whole::LegoLoam;
use crate::lidar3d::{
    Mapper3Counters, SpaceCloserCounters, SpaceMap, SpaceMapper, SurfaceCloud, SweepRecord, sweep_times,
    timed_pose,
};
use crate::metrics::TimedPose;
use crate::pose_graph::Unsolvable;

/// Pieces of a sweep within which the sensor is taken to stand.
const PIECES: usize = 64;

/// Maps a drive of a lidar of 16 lasers.
pub struct LegoMapper {
    config: LegoLoamConfig,
    loam: LegoLoam,
    cloud: SurfaceCloud,
    trajectory: Vec<TimedPose>,
    counters: Mapper3Counters,
    last: Option<(f64, Pose3)>,
    keys: usize,
}

impl LegoMapper {
    /// An empty map with cubes of the cloud of this edge, metres.
    #[must_use]
    pub fn new(config: LegoLoamConfig, cloud_m: f32) -> Self {
        Self {
            config,
            loam: LegoLoam::new(config),
            cloud: SurfaceCloud::new(cloud_m),
            trajectory: Vec::new(),
            counters: Mapper3Counters::default(),
            last: None,
            keys: 0,
        }
    }

    /// The returns of a sweep between two poses.
    fn draw(&mut self, sweep: &SweepRecord, [start, end]: [&Pose3; 2], time_s: f32) {
        let motion = start.inverse().compose(end);
        let (turn, step) = (motion.rotation_vector(), motion.place_m);
        let pieces: Vec<_> = (0..PIECES)
            .map(|piece| {
                let share = (piece as f64 + 0.5) / PIECES as f64;
                let pose = start.moved(turn * share, step * share);
                (pose.rotation.map(|part| part as f32), pose.place_m.map(|part| part as f32))
            })
            .collect();
        for (index, each) in sweep.returns.iter().enumerate() {
            if each.point_in_sensor.norm() < self.config.range_least_m {
                continue;
            }
            let piece = ((each.time_share * PIECES as f32) as usize).min(PIECES - 1);
            let (rotation, origin) = pieces[piece];
            let reflectivity = sweep.reflectivity.get(index).copied().unwrap_or(0);
            self.cloud.add(&(rotation * each.point_in_sensor + origin), reflectivity, time_s);
        }
    }
}

impl SpaceMapper for LegoMapper {
    fn take(&mut self, sweep: SweepRecord, _: &MotionAid) -> Result<(), Unsolvable> {
        if sweep_times(&sweep, self.last.map(|(time_s, _)| time_s)).is_none() {
            self.counters.not_later += 1;
            return Ok(());
        }
        let outcome = self.loam.push(&sweep.returns, sweep.end_s);
        self.counters.sweeps += 1;
        self.counters.blind += u64::from(outcome.is_blind);
        let first_s = self.trajectory.first().map_or(sweep.end_s, |first| first.time_s);
        self.trajectory.push(timed_pose(sweep.end_s, &outcome.pose));
        if self.loam.keys() > self.keys {
            self.keys = self.loam.keys();
            self.counters.mapped += 1;
            let start = self.last.map_or(outcome.pose, |(_, pose)| pose);
            self.draw(&sweep, [&start, &outcome.pose], (sweep.end_s - first_s) as f32);
        }
        self.last = Some((sweep.end_s, outcome.pose));
        Ok(())
    }

    fn conclude(&mut self) -> Result<SpaceMap, Unsolvable> {
        Ok(SpaceMap {
            trajectory: self.trajectory.clone(),
            cloud: self.cloud.clone(),
            counters: self.counters,
            held_deviation_m: None,
            cubes: [0; 2],
            loops: SpaceCloserCounters::default(),
            loops_believed: 0,
        })
    }
}
