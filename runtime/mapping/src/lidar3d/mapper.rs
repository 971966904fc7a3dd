//! Sweeps in, trajectory and cloud out.

use floorguard_mapping::lidar_odometry::{
    Bucket, LidarOdometry, MotionAid, OdometryConfig, Pose3, SweepOutcome, SweepTimes,
};
use nalgebra::{Matrix6, Quaternion, UnitQuaternion, Vector3};

use super::closing::{KeySweep, SmallPoints, SpaceCloser, SpaceCloserConfig};
use super::cloud::SurfaceCloud;
use super::patches::Patches;
use super::space_map::{Mapper3Counters, SpaceMap, SpaceMapper};
use super::sweep::{SweepRecord, sweep_times};
use crate::metrics::TimedPose;
use crate::pose_graph::Unsolvable;

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
    /// How loops are closed; without it they are not.
    pub closing: Option<SpaceCloserConfig>,
}

impl Default for Mapper3Config {
    fn default() -> Self {
        Self {
            odometry: OdometryConfig::default(),
            buckets: 1 << 14,
            cloud_m: 0.05,
            closing: Some(SpaceCloserConfig::default()),
        }
    }
}

/// Maps a drive. The map is the frame of the sensor at the end of the first sweep.
pub struct Mapper3 {
    odometry: LidarOdometry<Box<[Bucket]>, RETURNS>,
    closer: Option<SpaceCloser>,
    closing: SpaceCloserConfig,
    patches: Patches,
    /// Pose of the sensor at the end of each sweep by the odometry alone.
    odometry_poses: Vec<(f64, Pose3)>,
    /// Since the last key sweep: metres, and radians.
    path: [f64; 2],
    drift_m2: f64,
    key_poses: Vec<Pose3>,
    /// What became of the sweeps.
    pub counters: Mapper3Counters,
    /// Variance along the worst direction, and how much of it came with sweeps without information about one direction, square metres.
    variance_m2: [f64; 2],
    first_s: Option<f64>,
    last_s: Option<f64>,
    /// The first sweep waits for its motion.
    waiting: Option<SweepRecord>,
}

/// A turn wears the odometry as so many metres do, for each radian.
const METRES_PER_RADIAN: f64 = 0.3;

impl Mapper3 {
    /// An empty map.
    #[must_use]
    pub fn new(config: Mapper3Config) -> Self {
        let storage = vec![Bucket::EMPTY; config.buckets.max(1)].into_boxed_slice();
        Self {
            odometry: LidarOdometry::new(storage, config.odometry),
            closer: config.closing.map(SpaceCloser::new),
            closing: config.closing.unwrap_or_default(),
            patches: Patches::new(config.cloud_m, config.odometry.averaging.range_most_m),
            odometry_poses: Vec::new(),
            path: [0.0; 2],
            drift_m2: 0.0,
            key_poses: Vec::new(),
            counters: Mapper3Counters::default(),
            variance_m2: [0.0; 2],
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

    /// What closes the loops, if anything does.
    #[must_use]
    pub fn closer(&self) -> Option<&SpaceCloser> {
        self.closer.as_ref()
    }

    /// Takes a sweep; `None` if it is not later than the one before.
    ///
    /// # Errors
    /// A loop was found, and the graph cannot be solved.
    pub fn push(&mut self, sweep: SweepRecord, aid: &MotionAid) -> Result<Option<SweepOutcome>, Unsolvable> {
        let Some(times) = sweep_times(&sweep, self.last_s) else {
            self.counters.not_later += 1;
            return Ok(None);
        };
        self.last_s = Some(sweep.end_s);
        self.first_s.get_or_insert(sweep.end_s);
        let outcome = self.odometry.push(&sweep.returns, times, aid);
        let pose = outcome.state.pose;
        if let Some((_, last)) = self.odometry_poses.last() {
            let step = last.inverse().compose(&pose);
            self.path[0] += step.place_m.norm();
            self.path[1] += step.rotation_vector().norm();
        }
        self.odometry_poses.push((sweep.end_s, pose));
        self.counters.sweeps += 1;
        self.counters.blind += u64::from(outcome.is_blind);
        let is_held = outcome.weak.is_held_by_prediction && self.counters.sweeps > 2;
        self.counters.held += u64::from(is_held);
        let variance_m2 = outcome.weak.deviation_m * outcome.weak.deviation_m;
        let [before_m2, held_m2] = self.variance_m2;
        let gained_m2 = if is_held { (variance_m2 - before_m2).max(0.0) } else { 0.0 };
        self.variance_m2 = [variance_m2, held_m2 + gained_m2];
        self.counters.mapped += u64::from(outcome.is_mapped);
        if self.counters.sweeps == 1 {
            self.waiting = Some(sweep);
        } else if outcome.is_mapped {
            self.waiting = None;
            self.enter(&sweep, times, &outcome)?;
        }
        Ok(Some(outcome))
    }

    /// A drive of a single sweep has its cloud too; and the last part of the drive is searched for loops.
    ///
    /// # Errors
    /// The graph cannot be solved.
    pub fn finish(&mut self) -> Result<(), Unsolvable> {
        if let Some(sweep) = self.waiting.take() {
            let times = SweepTimes { since_last_s: sweep.duration_s, duration_s: sweep.duration_s };
            self.draw(&sweep, times, &Pose3::identity());
        }
        self.closer.as_mut().map_or(Ok(()), SpaceCloser::finish)
    }

    /// Pose of the sensor at the end of each sweep, with all loops closed.
    #[must_use]
    pub fn trajectory(&self) -> Vec<TimedPose> {
        let poses = self.odometry_poses.iter().enumerate();
        let corrected = |(sweep, (time_s, pose)): (usize, &(f64, Pose3))| {
            let closed = self.closer.as_ref().map(|closer| closer.corrected(sweep, pose));
            timed_pose(*time_s, &closed.unwrap_or(*pose))
        };
        poses.map(corrected).collect()
    }

    /// The surfaces, with all loops closed.
    #[must_use]
    pub fn cloud(&mut self) -> SurfaceCloud {
        let poses = match &self.closer {
            Some(closer) if !closer.poses.is_empty() => &closer.poses,
            _ => &self.key_poses,
        };
        self.patches.cloud(&|key| poses.get(key).copied().unwrap_or_else(Pose3::identity))
    }

    /// A key sweep.
    fn enter(
        &mut self,
        sweep: &SweepRecord,
        times: SweepTimes,
        outcome: &SweepOutcome,
    ) -> Result<(), Unsolvable> {
        let pose = outcome.state.pose;
        let covariance = self.covariance_since_key(outcome);
        self.draw(sweep, times, &pose);
        self.key_poses.push(pose);
        let motion = self.odometry.sweep_motion(times.duration_s);
        let back = pose.inverse();
        let at_end = |point: &Vector3<f32>, share: f32| {
            back.transform(&motion.transform(point, share).map(f64::from)).map(|value| value as f32)
        };
        let reach_m = self.odometry.config().averaging.range_most_m;
        let Some(closer) = &mut self.closer else { return Ok(()) };
        let mut means = SmallPoints::within(reach_m);
        for each in self.odometry.returns() {
            means.push(&at_end(&each.point_in_sensor, each.time_share));
        }
        let time_s = sweep.end_s - self.first_s.unwrap_or(sweep.end_s);
        let key = KeySweep { sweep: self.odometry_poses.len() - 1, time_s, pose, covariance, means };
        let near = self.odometry.config().averaging;
        let range = near.range_least_m..=near.range_most_m;
        let returns = sweep.returns.iter().filter(|each| range.contains(&each.point_in_sensor.norm()));
        closer.push(key, returns.map(|each| at_end(&each.point_in_sensor, each.time_share)))
    }

    /// What the odometry does not know of the motion since the last key sweep: so much for each metre; and along a direction
    /// that was not seen, what its doubt has grown by.
    fn covariance_since_key(&mut self, outcome: &SweepOutcome) -> Matrix6<f64> {
        let [path_m, turned_rad] = std::mem::take(&mut self.path);
        let worn_m = path_m + METRES_PER_RADIAN * turned_rad + 0.01;
        let mut covariance = Matrix6::zeros();
        let variances = [self.closing.turn_variance_per_m, self.closing.place_variance_per_m];
        for (row, variance) in [0, 3].into_iter().zip(variances) {
            covariance.fixed_view_mut::<3, 3>(row, row).fill_diagonal(variance * worn_m);
        }
        let drift_m2 = outcome.drift.fixed_view::<3, 3>(3, 3).trace();
        let grown_m2 = (drift_m2 - std::mem::replace(&mut self.drift_m2, drift_m2)).max(0.0);
        if outcome.weak.is_held_by_prediction {
            let direction = outcome.weak.direction;
            let mut block = covariance.fixed_view_mut::<3, 3>(3, 3);
            block += direction * direction.transpose() * grown_m2;
        }
        covariance
    }

    /// Its returns become part of the surfaces.
    fn draw(&mut self, sweep: &SweepRecord, times: SweepTimes, pose: &Pose3) {
        self.patches.begin(self.key_poses.len(), pose);
        let frame = self.patches.frame();
        let rotation = frame.rotation.map(|part| part as f32);
        let origin = frame.place_m.map(|part| part as f32);
        let motion = self.odometry.sweep_motion(times.duration_s);
        let config = self.odometry.config().averaging;
        let time_s = (sweep.end_s - self.first_s.unwrap_or(sweep.end_s)) as f32;
        for (index, each) in sweep.returns.iter().enumerate() {
            let range_m = each.point_in_sensor.norm();
            if !(config.range_least_m..=config.range_most_m).contains(&range_m) {
                continue;
            }
            let reflectivity = sweep.reflectivity.get(index).copied().unwrap_or(0);
            let in_map = motion.transform(&each.point_in_sensor, each.time_share);
            self.patches.add(&(rotation * in_map + origin), reflectivity, time_s);
        }
    }
}

impl SpaceMapper for Mapper3 {
    fn take(&mut self, sweep: SweepRecord, aid: &MotionAid) -> Result<(), Unsolvable> {
        self.push(sweep, aid).map(|_| ())
    }

    fn conclude(&mut self) -> Result<SpaceMap, Unsolvable> {
        self.finish()?;
        Ok(SpaceMap {
            trajectory: self.trajectory(),
            cloud: self.cloud(),
            counters: self.counters,
            held_deviation_m: Some(self.variance_m2[1].sqrt()),
            cubes: self.cubes(),
            loops: self.closer.as_ref().map(SpaceCloser::counters).unwrap_or_default(),
            loops_believed: self.closer.as_ref().map_or(0, SpaceCloser::believed),
        })
    }
}

/// A pose with its time, in the form of the metrics.
pub(crate) fn timed_pose(time_s: f64, pose: &Pose3) -> TimedPose {
    let [x, y, z, w] = pose.quaternion();
    let rotation = UnitQuaternion::from_quaternion(Quaternion::new(w, x, y, z));
    TimedPose { time_s, place_m: pose.place_m, rotation }
}
