//! How far the pose may be off in the map of the first sweep: what the filter cannot know, because its map is made of its own
//! poses.

use nalgebra::{Matrix6, Vector3};

use super::align::Weakest;
use super::filter::{MotionAid, MotionNoise, MotionState};

/// No robot is faster without that being known, m/s, one standard deviation.
const SPEED_MOST_MPS: f64 = 1.5;

/// Covariance of the pose in the map of the first sweep, in the sensor's axes.
#[derive(Clone, Copy, Debug)]
pub(super) struct Doubt {
    pub(super) covariance: Matrix6<f64>,
    /// Along the direction that is not seen: variance of the speed, and the doubt about the distance so far.
    speed_variance: f64,
    distance_m: f64,
}

/// What a sweep saw and did not see.
pub(super) struct Sight<'a> {
    pub(super) weakest: &'a Weakest,
    /// Share of the returns that no plane explained.
    pub(super) fresh: f64,
    pub(super) since_last_s: f64,
}

impl Doubt {
    /// The first sweep is the map; its speed is not known.
    pub(super) fn new(noise: &MotionNoise) -> Self {
        let speed = noise.linear_mps.norm_squared();
        Self { covariance: Matrix6::zeros(), speed_variance: speed, distance_m: 0.0 }
    }

    /// New surfaces are mapped with the error of the pose they are seen from: by the share of returns that no plane explained,
    /// the error of this sweep becomes one of the map. Along a direction that the returns say nothing about, the speed is
    /// less and less known, and its error adds up to one of the distance.
    pub(super) fn grow(
        &mut self,
        state: &MotionState,
        sight: &Sight<'_>,
        noise: &MotionNoise,
        aid: &MotionAid,
    ) {
        let transport = state.twist.over(sight.since_last_s).error_transport();
        let pose = state.covariance.fixed_view::<6, 6>(0, 0).into_owned();
        self.covariance =
            transport * self.covariance * transport.transpose() + pose * sight.fresh.clamp(0.0, 1.0);
        let Weakest { direction, share, .. } = sight.weakest;
        let square = |deviation: &Vector3<f64>| deviation.component_mul(direction).norm_squared();
        if *share >= 1.0 {
            let speed = state.covariance.fixed_view::<3, 3>(9, 9).into_owned();
            (self.speed_variance, self.distance_m) = ((speed * direction).dot(direction), 0.0);
            return;
        }
        let grown = self.speed_variance + square(&noise.linear_mps) * sight.since_last_s;
        let wheels = aid.wheels.map(|wheels| square(&wheels.linear_mps.deviation));
        let most = wheels.unwrap_or(SPEED_MOST_MPS * SPEED_MOST_MPS);
        self.speed_variance = grown.min(most).max(0.0);
        let step_m = libm::sqrt(self.speed_variance) * sight.since_last_s * (1.0 - share);
        // One error of the speed moves all steps alike: the distances add up, not their squares.
        let more = step_m * (2.0 * self.distance_m + step_m);
        self.distance_m += step_m;
        let mut block = self.covariance.fixed_view_mut::<3, 3>(3, 3);
        block += direction * direction.transpose() * more;
    }
}
