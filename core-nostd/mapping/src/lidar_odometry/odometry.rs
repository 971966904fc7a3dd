//! The whole: average, predict, align, enter into the map.

use floorguard_types::number::{nearest_f32_of_f64, nearest_f64};
use heapless::Vec;
use nalgebra::{Matrix6, Vector3};

use super::align::{AlignConfig, Match, Round, Sums, measure};
use super::averaging::{AveragedReturn, AveragingConfig, SweepReturn, average_returns};
use super::filter::{FloorPrior, Matrix12, MotionAid, MotionNoise, MotionState, Quadratic, Vector12};
use super::outcome::{SweepOutcome, WeakDirection};
use super::sweep_motion::SweepMotion;
use super::voxel_map::{Bucket, VoxelMap, VoxelMapConfig, symmetric_eigen};

/// All settings.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct OdometryConfig {
    /// How returns are averaged.
    pub averaging: AveragingConfig,
    /// Cubes of the map.
    pub map: VoxelMapConfig,
    /// How returns are matched.
    pub align: AlignConfig,
    /// How the motion changes.
    pub noise: MotionNoise,
    /// A level floor.
    pub floor: Option<FloorPrior>,
    /// When sweeps enter the map.
    pub entering: Entering,
}

/// When a sweep enters the map: after a motion, and the first ones at a place.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Entering {
    /// Metres since the last one that entered.
    pub step_m: f64,
    /// Radians since then.
    pub turn_rad: f64,
    /// So many enter at a place where the sensor stands; more would only let the map creep.
    pub standing: u32,
}

impl Default for Entering {
    fn default() -> Self {
        Self { step_m: 0.05, turn_rad: 2.0_f64.to_radians(), standing: 8 }
    }
}

/// Times of a sweep.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SweepTimes {
    /// From the end of the sweep before to the end of this one, seconds, > 0.
    pub since_last_s: f64,
    /// From its first return to its last, seconds, > 0.
    pub duration_s: f64,
}

/// Tells where a lidar moves. `S` stores the map; `N` averaged returns of a sweep fit.
///
/// The frame of the map is that of the sensor at the end of the first sweep.
#[derive(Clone, Debug)]
pub struct LidarOdometry<S, const N: usize> {
    config: OdometryConfig,
    map: VoxelMap<S>,
    state: MotionState,
    drift: Matrix6<f64>,
    returns: Vec<AveragedReturn, N>,
    matches: Vec<Match, N>,
    /// The first sweep, until its motion is known.
    first: Vec<AveragedReturn, N>,
    first_duration_s: f64,
    sweeps: u32,
    entered: MotionState,
    standing: u32,
}

/// Rounds in which the first two sweeps are straightened by each other.
const FIRST_ROUNDS: u32 = 3;

impl<S: AsRef<[Bucket]> + AsMut<[Bucket]>, const N: usize> LidarOdometry<S, N> {
    /// An odometry that has seen nothing.
    #[must_use]
    pub fn new(storage: S, config: OdometryConfig) -> Self {
        Self {
            config,
            map: VoxelMap::new(storage, config.map),
            state: MotionState::at_origin(),
            drift: Matrix6::zeros(),
            returns: Vec::new(),
            matches: Vec::new(),
            first: Vec::new(),
            first_duration_s: 0.0,
            sweeps: 0,
            entered: MotionState::at_origin(),
            standing: 0,
        }
    }

    /// The settings.
    #[must_use]
    pub const fn config(&self) -> &OdometryConfig {
        &self.config
    }

    /// The map of planes.
    #[must_use]
    pub const fn map(&self) -> &VoxelMap<S> {
        &self.map
    }

    /// The averaged returns of the newest sweep, in the sensor's frame at their times.
    #[must_use]
    pub fn returns(&self) -> &[AveragedReturn] {
        &self.returns
    }

    /// The motion of the newest sweep, which places its returns in the map.
    #[must_use]
    pub fn sweep_motion(&self, duration_s: f64) -> SweepMotion {
        SweepMotion::new(&self.state.pose, &self.state.twist, duration_s)
    }

    /// Takes a sweep: returns in the order of firing. Cost: see the book (Lidar odometry in space: Cost).
    pub fn push(&mut self, sweep: &[SweepReturn], times: SweepTimes, aid: &MotionAid) -> SweepOutcome {
        let dropped = average_returns(sweep, &self.config.averaging, &mut self.returns);
        let is_first = self.sweeps == 0;
        self.sweeps = self.sweeps.saturating_add(1);
        let outcome = if is_first {
            self.begin(times)
        } else if self.sweeps == 2 {
            self.second(times, aid)
        } else {
            let before = self.state.predicted(times.since_last_s, &self.config.noise);
            self.follow(&before, times, aid)
        };
        SweepOutcome { dropped, ..outcome }
    }

    fn begin(&mut self, times: SweepTimes) -> SweepOutcome {
        self.first.clone_from(&self.returns);
        self.first_duration_s = times.duration_s;
        let mut outcome = self.outcome(&Sums::none(), &self.state.covariance.clone());
        outcome.is_mapped = self.enter(times.duration_s);
        outcome.is_blind = self.returns.is_empty();
        outcome
    }

    /// The first sweep was entered as if the sensor stood; now its velocity shows, and it is entered again.
    fn second(&mut self, times: SweepTimes, aid: &MotionAid) -> SweepOutcome {
        let start = self.state;
        let mut outcome = None;
        for _ in 0..FIRST_ROUNDS {
            let begun = MotionState { twist: self.state.twist, ..start };
            self.map.clear();
            let motion = SweepMotion::new(&start.pose, &begun.twist, self.first_duration_s);
            for each in &self.first {
                self.map.insert(&motion.transform(&each.point_in_sensor, each.time_share), 1);
            }
            let before = begun.predicted(times.since_last_s, &self.config.noise);
            outcome = Some(self.align(&before, times, aid));
        }
        let mut outcome = outcome.unwrap_or_else(|| self.outcome(&Sums::none(), &start.covariance));
        outcome.is_mapped = self.enter(times.duration_s);
        outcome
    }

    fn follow(&mut self, before: &MotionState, times: SweepTimes, aid: &MotionAid) -> SweepOutcome {
        let mut outcome = self.align(before, times, aid);
        if !outcome.is_blind && self.is_due() {
            outcome.is_mapped = self.enter(times.duration_s);
        }
        outcome
    }

    /// Finds the state that fits the returns, the prediction, and what else is known.
    fn align(&mut self, before: &MotionState, times: SweepTimes, aid: &MotionAid) -> SweepOutcome {
        let Some(information) = before.information() else {
            return self.outcome(&Sums::none(), &before.covariance);
        };
        self.matches.clear();
        // The same capacity: it always fits.
        let _ = self.matches.resize(self.returns.len(), Match::OPEN);
        self.state = *before;
        let config = self.config.align;
        let mut widening = config.kernel_first;
        let mut sums = Sums::none();
        for _ in 0..config.rounds {
            let motion = SweepMotion::new(&self.state.pose, &self.state.twist, times.duration_s);
            let wide = config.kernel * widening;
            let round = Round { config: &config, kernel: wide * wide, motion: &motion };
            let end = self.state.pose.place_m.map(nearest_f32_of_f64);
            sums = measure((&self.returns, &mut self.matches), &self.map, &round, &end);
            let Some(step) = self.correct((before, &information), &sums, aid) else { break };
            let moved = step.fixed_rows::<3>(3).norm_squared() < config.step_m * config.step_m;
            let turned = step.fixed_rows::<3>(0).norm_squared() < config.turn_rad * config.turn_rad;
            if moved && turned && widening <= 1.0 {
                break;
            }
            widening = libm::sqrtf(widening);
            if widening < 1.3 {
                widening = 1.0;
            }
        }
        let outcome = self.outcome(&sums, &before.covariance);
        self.grow_drift(&sums, times.since_last_s);
        SweepOutcome { drift: self.drift, ..outcome }
    }

    /// One round of Gauss and Newton. `None` if the sum of all information is not positive.
    fn correct(
        &mut self,
        (before, information): (&MotionState, &Matrix12),
        sums: &Sums,
        aid: &MotionAid,
    ) -> Option<Vector12> {
        let mut all = Quadratic::of_prior(information, &self.state.difference(before));
        all.add_aid(aid, &self.state.twist);
        if let Some(floor) = &self.config.floor {
            all.add_floor(floor, &self.state.pose);
        }
        if sums.matched >= self.config.align.matched_least {
            let lidar = sums.quadratic(&self.state.pose, self.config.align.alike);
            all.information += lidar.information;
            all.gradient += lidar.gradient;
        }
        let factor = all.information.cholesky()?;
        let step = -factor.solve(&all.gradient);
        self.state = self.state.corrected(&step);
        self.state.covariance = factor.inverse();
        Some(step)
    }

    fn is_due(&mut self) -> bool {
        let since = self.entered.pose.inverse().compose(&self.state.pose);
        let entering = self.config.entering;
        let has_moved = since.place_m.norm_squared() > entering.step_m * entering.step_m
            || since.rotation_vector().norm_squared() > entering.turn_rad * entering.turn_rad;
        if has_moved {
            self.standing = 0;
            self.entered = self.state;
        }
        self.standing = self.standing.saturating_add(1);
        self.standing <= entering.standing
    }

    fn enter(&mut self, duration_s: f64) -> bool {
        let motion = self.sweep_motion(duration_s);
        for each in &self.returns {
            self.map.insert(&motion.transform(&each.point_in_sensor, each.time_share), self.sweeps);
        }
        !self.returns.is_empty()
    }

    /// New surfaces are mapped with the error of the pose they are seen from: by the share of returns that no plane
    /// explained, the error of this sweep becomes one of the map.
    fn grow_drift(&mut self, sums: &Sums, since_last_s: f64) {
        let all = nearest_f64(floorguard_types::number::count_u32(self.returns.len()).max(1));
        let fresh = 1.0 - nearest_f64(sums.matched) / all;
        let transport = self.state.twist.over(since_last_s).error_transport();
        let pose = self.state.covariance.fixed_view::<6, 6>(0, 0).into_owned();
        self.drift = transport * self.drift * transport.transpose() + pose * fresh.clamp(0.0, 1.0);
    }

    fn outcome(&self, sums: &Sums, before: &Matrix12) -> SweepOutcome {
        let config = &self.config.align;
        SweepOutcome {
            state: self.state,
            drift: self.drift,
            returns: floorguard_types::number::count_u32(self.returns.len()),
            matched: sums.matched,
            dropped: 0,
            misfit: libm::sqrt(sums.squares / sums.kernels.max(1.0)),
            weak: weak_direction(&self.state.covariance, before),
            is_blind: sums.matched < config.matched_least,
            is_mapped: false,
        }
    }
}

/// The longest axis of the place's covariance.
fn weak_direction(after: &Matrix12, before: &Matrix12) -> WeakDirection {
    let block = |m: &Matrix12| m.fixed_view::<3, 3>(3, 3).into_owned();
    let (after, before) = (block(after), block(before));
    // Within the range of single precision whatever the unit.
    let scale = after.trace().max(1.0e-30);
    let short = |value: f64| nearest_f32_of_f64(value / scale);
    let eigen = symmetric_eigen([after.m11, after.m12, after.m13, after.m22, after.m23, after.m33].map(short));
    let [_, _, direction] = eigen.vectors;
    let direction: Vector3<f64> = direction.map(f64::from);
    let along = |m: &nalgebra::Matrix3<f64>| (m * direction).dot(&direction).max(0.0);
    WeakDirection {
        direction,
        deviation_m: libm::sqrt(along(&after)),
        is_held_by_prediction: along(&after) > 0.5 * along(&before),
    }
}
