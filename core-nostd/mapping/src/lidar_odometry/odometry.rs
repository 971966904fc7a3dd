//! The whole: average, predict, align, enter into the map.

use floorguard_types::number::{count_u32, nearest_f32_of_f64, nearest_f64};
use heapless::Vec;
use nalgebra::{Matrix3, Matrix6};

use super::align::{AlignConfig, Match, Sums, Weakest};
use super::averaging::{AveragedReturn, AveragingConfig, SweepReturn, average_returns};
use super::doubt::{Doubt, Sight};
use super::filter::{FloorPrior, MotionAid, MotionNoise, MotionState};
use super::outcome::{SweepOutcome, WeakDirection};
use super::solve::{Effort, Found, Knowledge, Rounds, solve};
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
        Self { step_m: 0.2, turn_rad: 8.0_f64.to_radians(), standing: 1 }
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
    doubt: Doubt,
    returns: Vec<AveragedReturn, N>,
    matches: Vec<Match, N>,
    /// The first sweep, until its motion is known.
    first: Vec<AveragedReturn, N>,
    first_duration_s: f64,
    sweeps: u32,
    entered: MotionState,
    standing: u32,
    /// Share of the returns that lies on the map, smoothed.
    usual: Option<f64>,
}

/// A result with less than this share of the usual returns on the map is looked for again.
const USUAL_SHARE: f64 = 0.8;
/// At rest nothing but people changes what is seen: fewer than this share, and the sensor has moved.
const REST_SHARE: f64 = 0.97;
/// Below this speed the sensor may be at rest, m/s...
const REST_MPS: f64 = 0.05;
/// ... and below this rate, rad/s.
const REST_RADPS: f64 = 0.03;
/// The returns alone may ask for a pose so many squared deviations away from rest. Deviations allow for neighbours that err
/// alike, so noise stays far below one.
const REST_TENSION_MOST: f64 = 1.0;
/// Rest is believed where each direction of the place is seen this well, in multiples of what noise would say.
const REST_TIMES_NOISE: f64 = 200.0;
/// Rounds in which the first two sweeps are straightened by each other.
const FIRST_ROUNDS: u32 = 3;

impl<S: AsRef<[Bucket]> + AsMut<[Bucket]>, const N: usize> LidarOdometry<S, N> {
    /// An odometry that has seen nothing.
    #[must_use]
    pub fn new(storage: S, config: OdometryConfig) -> Self {
        Self {
            config,
            map: VoxelMap::new(storage, config.map),
            state: MotionState::at_origin(&config.noise),
            doubt: Doubt::new(&config.noise),
            returns: Vec::new(),
            matches: Vec::new(),
            first: Vec::new(),
            first_duration_s: 0.0,
            sweeps: 0,
            entered: MotionState::at_origin(&config.noise),
            standing: 0,
            usual: None,
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
            self.follow(times, aid)
        };
        SweepOutcome { dropped, ..outcome }
    }

    fn begin(&mut self, times: SweepTimes) -> SweepOutcome {
        self.first.clone_from(&self.returns);
        self.first_duration_s = times.duration_s;
        let mut outcome = self.outcome(&Sums::none(), &Weakest::of_nothing());
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
            self.usual = None;
            outcome = Some(self.align(&begun, times, aid));
        }
        let mut outcome = outcome.unwrap_or_else(|| self.outcome(&Sums::none(), &Weakest::of_nothing()));
        outcome.is_mapped = self.enter(times.duration_s);
        outcome
    }

    fn follow(&mut self, times: SweepTimes, aid: &MotionAid) -> SweepOutcome {
        let last = self.state;
        let mut outcome = self.align(&last, times, aid);
        if !outcome.is_blind && self.is_due() {
            outcome.is_mapped = self.enter(times.duration_s);
        }
        outcome
    }

    /// Finds the state that fits the returns, the prediction, and what else is known. A sensor that stood is first believed to
    /// stand still; a result that fits worse than the last ones did is looked for again, farther away.
    fn align(&mut self, last: &MotionState, times: SweepTimes, aid: &MotionAid) -> SweepOutcome {
        let config = self.config.align;
        let before = last.predicted(times.since_last_s, &self.config.noise);
        let resting = is_at_rest(last).then(|| last.resting());
        let resting = resting.and_then(|resting| {
            let found = self.solve(&resting, (times, aid), config.rounds_of(Effort::Usual))?;
            (found.tension < REST_TENSION_MOST && found.weakest.times_noise > REST_TIMES_NOISE)
                .then_some(found)
        });
        let at_rest = |rest: &Found, kernels: f64| rest.sums.kernels > REST_SHARE * kernels;
        let all = nearest_f64(count_u32(self.returns.len()));
        let usual = self.usual.map(|share| share * all);
        let mut found = resting.filter(|rest| usual.is_none_or(|usual| at_rest(rest, usual)));
        if found.is_none() || usual.is_none() {
            let rest = found;
            found = self.solve(&before, (times, aid), config.rounds_of(Effort::Usual));
            if !found.as_ref().is_some_and(|found| self.is_usual(&found.sums)) {
                let wide = self.solve(&before, (times, aid), config.rounds_of(Effort::Wide));
                found = better(found, wide);
            }
            let kernels = found.as_ref().map_or(0.0, |found| found.sums.kernels);
            found = rest.filter(|rest| at_rest(rest, kernels)).or(found);
        }
        let Some(Found { state, sums, weakest, .. }) = found else {
            self.state = before;
            let sight =
                Sight { weakest: &Weakest::of_nothing(), fresh: 1.0, since_last_s: times.since_last_s };
            self.doubt.grow(&before, &sight, &self.config.noise, aid);
            return self.outcome(&Sums::none(), &Weakest::of_nothing());
        };
        self.state = state;
        self.remember(&sums);
        let all = nearest_f64(count_u32(self.returns.len()).max(1));
        let fresh = 1.0 - nearest_f64(sums.matched) / all;
        let sight = Sight { weakest: &weakest, fresh, since_last_s: times.since_last_s };
        self.doubt.grow(&self.state, &sight, &self.config.noise, aid);
        self.outcome(&sums, &weakest)
    }

    fn solve(
        &mut self,
        before: &MotionState,
        (times, aid): (SweepTimes, &MotionAid),
        rounds: Rounds,
    ) -> Option<Found> {
        let knowledge = Knowledge { aid, floor: self.config.floor.as_ref(), duration_s: times.duration_s };
        self.matches.clear();
        // The same capacity: it always fits.
        let _ = self.matches.resize(self.returns.len(), Match::OPEN);
        let returns = (self.returns.as_slice(), self.matches.as_mut_slice());
        solve(before, returns, &self.map, (&self.config.align, rounds, &knowledge))
    }

    /// Whether about as many returns lie on the map as did before; false while that is not known.
    fn is_usual(&self, sums: &Sums) -> bool {
        let is_enough = |usual| self.share(sums) > USUAL_SHARE * usual;
        sums.matched >= self.config.align.matched_least && self.usual.is_some_and(is_enough)
    }

    fn share(&self, sums: &Sums) -> f64 {
        sums.kernels / nearest_f64(count_u32(self.returns.len()).max(1))
    }

    fn remember(&mut self, sums: &Sums) {
        let share = self.share(sums);
        self.usual = Some(self.usual.map_or(share, |usual| usual + 0.2 * (share - usual)));
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

    fn outcome(&self, sums: &Sums, weakest: &Weakest) -> SweepOutcome {
        let config = &self.config.align;
        let place = |m: &Matrix6<f64>| m.fixed_view::<3, 3>(3, 3).into_owned();
        let now = self.state.covariance.fixed_view::<6, 6>(0, 0).into_owned();
        SweepOutcome {
            state: self.state,
            drift: self.doubt.covariance,
            returns: count_u32(self.returns.len()),
            matched: sums.matched,
            dropped: 0,
            misfit: libm::sqrt(sums.squares / sums.kernels.max(1.0)),
            times_noise: weakest.times_noise,
            weak: weak_direction(&(place(&now) + place(&self.doubt.covariance)), weakest.is_silent()),
            is_blind: sums.matched < config.matched_least,
            is_mapped: false,
        }
    }
}

fn is_at_rest(state: &MotionState) -> bool {
    state.twist.linear_mps.norm_squared() < REST_MPS * REST_MPS
        && state.twist.angular_radps.norm_squared() < REST_RADPS * REST_RADPS
}

/// The one with more returns on the map.
fn better(one: Option<Found>, other: Option<Found>) -> Option<Found> {
    let kernels = |found: &Option<Found>| found.as_ref().map_or(-1.0, |found| found.sums.kernels);
    if kernels(&other) > kernels(&one) { other } else { one }
}

/// The longest axis of the place's covariance.
fn weak_direction(place: &Matrix3<f64>, is_held_by_prediction: bool) -> WeakDirection {
    // Within the range of single precision whatever the unit.
    let scale = place.trace().max(1.0e-30);
    let short = |value: f64| nearest_f32_of_f64(value / scale);
    let [xx, xy, xz] = [place.m11, place.m12, place.m13];
    let eigen = symmetric_eigen([xx, xy, xz, place.m22, place.m23, place.m33].map(short));
    let ([.., value], [.., direction]) = (eigen.values, eigen.vectors);
    let deviation_m = libm::sqrt(f64::from(value).max(0.0) * scale);
    WeakDirection { direction: direction.map(f64::from), deviation_m, is_held_by_prediction }
}

#[cfg(test)]
#[path = "odometry_tests.rs"]
mod tests;
