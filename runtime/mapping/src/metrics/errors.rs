//! Absolute and relative errors of a trajectory against a true one, as the program `evo` counts them (Grupp 2017): poses
//! that are nearest in time belong together, the absolute error is taken after the best rigid motion (Umeyama 1991),
//! the relative error of the steps needs none.

use nalgebra::{Matrix3, Vector3};

use super::trajectory::TimedPose;
use crate::turn::turn_angle_rad;

/// A pose of the truth and the pose of the result that belongs to it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PosePair {
    /// Of the truth.
    pub truth: TimedPose,
    /// Of the result.
    pub result: TimedPose,
}

/// Sum and spread of errors; all zero without errors.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ErrorStatistics {
    /// How many.
    pub count: usize,
    /// Root of the mean square.
    pub rmse: f64,
    /// Mean.
    pub mean: f64,
    /// The one in the middle; between the two middle ones of an even number.
    pub median: f64,
    /// Standard deviation of all.
    pub deviation: f64,
    /// Largest.
    pub most: f64,
}

/// Which steps the relative error looks at.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum StepLength {
    /// Every so many poses, ≥ 1.
    Poses(usize),
    /// Every so many metres of the result's path, > 0.
    Metres(f64),
}

/// Error of the steps.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct RelativeErrors {
    /// Metres.
    pub translation_m: Vec<f64>,
    /// Radians.
    pub rotation_rad: Vec<f64>,
}

/// For each pose of the shorter trajectory the nearest one of the longer, if it lies within `tolerance_s`; both ordered by
/// time.
#[must_use]
pub fn associate(truth: &[TimedPose], result: &[TimedPose], tolerance_s: f64) -> Vec<PosePair> {
    let truth_is_shorter = truth.len() < result.len();
    let (short, long) = if truth_is_shorter { (truth, result) } else { (result, truth) };
    let partner = |pose: &TimedPose| {
        let after = long.partition_point(|other| other.time_s < pose.time_s);
        let near = long.get(after.saturating_sub(1)..(after + 1).min(long.len()))?;
        let away = |other: &&TimedPose| (other.time_s - pose.time_s).abs();
        let nearest = near.iter().min_by(|a, b| away(a).total_cmp(&away(b)))?;
        (away(&nearest) <= tolerance_s).then_some(*nearest)
    };
    let pair = |pose: &TimedPose| {
        let other = partner(pose)?;
        let (truth, result) = if truth_is_shorter { (*pose, other) } else { (other, *pose) };
        Some(PosePair { truth, result })
    };
    short.iter().filter_map(pair).collect()
}

/// Distances after the result was laid onto the truth by the best rigid motion, metres. Empty with fewer than three pairs.
#[must_use]
pub fn absolute_errors(pairs: &[PosePair]) -> Vec<f64> {
    let Some((rotation, shift)) = rigid_motion(pairs) else { return Vec::new() };
    let distance = |pair: &PosePair| (rotation * pair.result.place_m + shift - pair.truth.place_m).norm();
    pairs.iter().map(distance).collect()
}

/// The rotation and shift that lay the result onto the truth with the least squared distance, without scale.
fn rigid_motion(pairs: &[PosePair]) -> Option<(Matrix3<f64>, Vector3<f64>)> {
    if pairs.len() < 3 {
        return None;
    }
    let count = pairs.len() as f64;
    let mean = |place: fn(&PosePair) -> Vector3<f64>| pairs.iter().map(place).sum::<Vector3<f64>>() / count;
    let (truth, result) = (mean(|pair| pair.truth.place_m), mean(|pair| pair.result.place_m));
    let spread = |pair: &PosePair| (pair.truth.place_m - truth) * (pair.result.place_m - result).transpose();
    let covariance: Matrix3<f64> = pairs.iter().map(spread).sum::<Matrix3<f64>>() / count;
    let parts = covariance.svd(true, true);
    let (left, right) = (parts.u?, parts.v_t?);
    let mirrored = left.determinant() * right.determinant() < 0.0;
    let sign = Matrix3::from_diagonal(&Vector3::new(1.0, 1.0, if mirrored { -1.0 } else { 1.0 }));
    let rotation = left * sign * right;
    Some((rotation, truth - rotation * result))
}

/// Error of each step of the result against the same step of the truth.
#[must_use]
pub fn relative_errors(pairs: &[PosePair], step: StepLength) -> RelativeErrors {
    let ends = step_ends(pairs, step);
    let mut errors = RelativeErrors::default();
    for end in ends.windows(2) {
        let &[from, to] = end else { continue };
        let (from, to) = (pairs[from], pairs[to]);
        let moved = |a: &TimedPose, b: &TimedPose| {
            (a.rotation.inverse() * (b.place_m - a.place_m), a.rotation.inverse() * b.rotation)
        };
        let (true_shift, true_turn) = moved(&from.truth, &to.truth);
        let (shift, turn) = moved(&from.result, &to.result);
        errors.translation_m.push((shift - true_shift).norm());
        errors.rotation_rad.push(turn_angle_rad(&(true_turn.inverse() * turn)));
    }
    errors
}

fn step_ends(pairs: &[PosePair], step: StepLength) -> Vec<usize> {
    let length_m = match step {
        StepLength::Poses(count) => return (0..pairs.len()).step_by(count.max(1)).collect(),
        StepLength::Metres(length_m) => length_m,
    };
    let mut ends = vec![0];
    let mut path_m = 0.0;
    let mut before = pairs.first().map_or_else(Vector3::zeros, |pair| pair.result.place_m);
    for (index, pair) in pairs.iter().enumerate().skip(1) {
        path_m += (pair.result.place_m - before).norm();
        before = pair.result.place_m;
        if path_m >= length_m {
            ends.push(index);
            path_m = 0.0;
        }
    }
    ends
}

impl ErrorStatistics {
    /// Of these errors.
    #[must_use]
    pub fn of(errors: &[f64]) -> Self {
        if errors.is_empty() {
            return Self::default();
        }
        let count = errors.len();
        let mean = errors.iter().sum::<f64>() / count as f64;
        let square = |from: f64| errors.iter().map(|e| (e - from) * (e - from)).sum::<f64>() / count as f64;
        let mut sorted = errors.to_vec();
        sorted.sort_by(f64::total_cmp);
        let median = 0.5 * (sorted[(count - 1) / 2] + sorted[count / 2]);
        let most = sorted[count - 1];
        Self { count, rmse: square(0.0).sqrt(), mean, median, deviation: square(mean).sqrt(), most }
    }
}

#[cfg(test)]
#[path = "errors_tests.rs"]
mod tests;
