//! Sweeps in, trajectory and cloud out.

use floorguard_mapping::lidar_odometry::{
    Bucket, LidarOdometry, MotionAid, OdometryConfig, Pose3, SweepOutcome, SweepTimes,
};
use nalgebra::{Quaternion, UnitQuaternion};

use super::cloud::SurfaceCloud;
use super::sweep::{SweepRecord, sweep_times};
use crate::metrics::TimedPose;

/// Averaged returns of a sweep that fit: 32 lasers with 1,800 returns each.
const RETURNS: usize = 8_192;

/// Settings of a map.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Mapper3Config {
    /// Of the odometry.
    pub odometry: OdometryConfig,
    /// Buckets of its map of planes, a power of two; each has eight cubes and takes 672 bytes.
    pub buckets: usize,
    /// Edge of a cube of the cloud, metres.
    pub cloud_m: f32,
}

impl Default for Mapper3Config {
    fn default() -> Self {
        Self { odometry: OdometryConfig::default(), buckets: 1 << 14, cloud_m: 0.05 }
    }
}

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

/// Maps a drive.
#[derive(Clone, Debug)]
pub struct Mapper3 {
    odometry: LidarOdometry<Box<[Bucket]>, RETURNS>,
    /// The surfaces so far.
    pub cloud: SurfaceCloud,
    /// Pose of the sensor at the end of each sweep, in the frame of the first one.
    pub trajectory: Vec<TimedPose>,
    /// What became of the sweeps.
    pub counters: Mapper3Counters,
    first_s: Option<f64>,
    last_s: Option<f64>,
    /// The first sweep waits for its motion.
    waiting: Option<SweepRecord>,
}

impl Mapper3 {
    /// An empty map.
    #[must_use]
    pub fn new(config: Mapper3Config) -> Self {
        let storage = vec![Bucket::EMPTY; config.buckets.max(1)].into_boxed_slice();
        Self {
            odometry: LidarOdometry::new(storage, config.odometry),
            cloud: SurfaceCloud::new(config.cloud_m),
            trajectory: Vec::new(),
            counters: Mapper3Counters::default(),
            first_s: None,
            last_s: None,
            waiting: None,
        }
    }

    /// Cubes of the map of planes, and how many it gave up.
    #[must_use]
    pub fn cubes(&self) -> [u32; 2] {
        [self.odometry.map().len(), self.odometry.map().replaced()]
    }

    /// Takes a sweep; `None` if it is not later than the one before.
    pub fn push(&mut self, sweep: SweepRecord, aid: &MotionAid) -> Option<SweepOutcome> {
        let Some(times) = sweep_times(&sweep, self.last_s) else {
            self.counters.not_later += 1;
            return None;
        };
        self.last_s = Some(sweep.end_s);
        let first_s = *self.first_s.get_or_insert(sweep.end_s);
        let outcome = self.odometry.push(&sweep.returns, times, aid);
        self.trajectory.push(timed_pose(sweep.end_s, &outcome.state.pose));
        self.counters.sweeps += 1;
        self.counters.blind += u64::from(outcome.is_blind);
        self.counters.held += u64::from(outcome.weak.is_held_by_prediction && self.counters.sweeps > 2);
        self.counters.mapped += u64::from(outcome.is_mapped);
        if self.counters.sweeps == 1 {
            self.waiting = Some(sweep);
        } else if outcome.is_mapped {
            self.waiting = None;
            self.enter(&sweep, times, (sweep.end_s - first_s) as f32);
        }
        Some(outcome)
    }

    /// A drive of a single sweep has its cloud too.
    pub fn finish(&mut self) {
        if let Some(sweep) = self.waiting.take() {
            let times = SweepTimes { since_last_s: sweep.duration_s, duration_s: sweep.duration_s };
            self.enter(&sweep, times, 0.0);
        }
    }

    fn enter(&mut self, sweep: &SweepRecord, times: SweepTimes, time_s: f32) {
        let motion = self.odometry.sweep_motion(times.duration_s);
        let config = self.odometry.config().averaging;
        for (index, each) in sweep.returns.iter().enumerate() {
            let range_m = each.point_in_sensor.norm();
            if !(config.range_least_m..=config.range_most_m).contains(&range_m) {
                continue;
            }
            let reflectivity = sweep.reflectivity.get(index).copied().unwrap_or(0);
            self.cloud.add(&motion.transform(&each.point_in_sensor, each.time_share), reflectivity, time_s);
        }
    }
}

fn timed_pose(time_s: f64, pose: &Pose3) -> TimedPose {
    let [x, y, z, w] = pose.quaternion();
    let rotation = UnitQuaternion::from_quaternion(Quaternion::new(w, x, y, z));
    TimedPose { time_s, place_m: pose.place_m, rotation }
}
