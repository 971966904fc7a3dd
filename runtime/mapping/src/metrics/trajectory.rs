//! Trajectories in the text format of the TUM benchmark: `time x y z qx qy qz qw` a line (Sturm et al. 2012).

use std::fmt::Write as _;

use nalgebra::{Quaternion, UnitQuaternion, Vector3};

use crate::se2::Se2;

/// Where something stood in space at a time.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TimedPose {
    /// Seconds.
    pub time_s: f64,
    /// Metres.
    pub place_m: Vector3<f64>,
    /// From the moving frame to the fixed one.
    pub rotation: UnitQuaternion<f64>,
}

/// A line that is no pose.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("line {line}: eight numbers are expected (time x y z qx qy qz qw)")]
pub struct TumError {
    /// Number of the line, from 1.
    pub line: usize,
}

/// Reads a trajectory. Empty lines and comments (`#`) are left out; a quaternion is normalised.
///
/// # Errors
/// A line has fewer numbers, one that is not finite, or a quaternion of length zero.
pub fn read_tum(text: &str) -> Result<Vec<TimedPose>, TumError> {
    let mut poses = Vec::new();
    for (index, line) in text.lines().enumerate() {
        let line = line.trim();
        if line.is_empty() || line.starts_with('#') {
            continue;
        }
        poses.push(pose_of(line).ok_or(TumError { line: index + 1 })?);
    }
    Ok(poses)
}

fn pose_of(line: &str) -> Option<TimedPose> {
    let number = |word: &str| word.parse::<f64>().ok().filter(|number| number.is_finite());
    let numbers: Option<Vec<f64>> =
        line.split([' ', '\t', ',']).filter(|word| !word.is_empty()).map(number).collect();
    let [time_s, x, y, z, qx, qy, qz, qw] = *numbers?.first_chunk::<8>()?;
    let rotation = UnitQuaternion::try_new(Quaternion::new(qw, qx, qy, qz), 1.0e-6)?;
    Some(TimedPose { time_s, place_m: Vector3::new(x, y, z), rotation })
}

/// A trajectory on the floor as text, times with microseconds.
#[must_use]
pub fn write_tum(trajectory: &[(f64, Se2)]) -> String {
    let mut text = String::from("# time_s x_m y_m z_m qx qy qz qw\n");
    for (time_s, pose) in trajectory {
        let (sin, cos) = libm::sincos(0.5 * pose.heading_rad);
        // Writing to a string cannot fail.
        let _ = writeln!(text, "{time_s:.6} {:.6} {:.6} 0 0 0 {sin:.9} {cos:.9}", pose.x_m, pose.y_m);
    }
    text
}

/// A trajectory in space as text, times with microseconds.
#[must_use]
pub fn write_tum_in_space(trajectory: &[TimedPose]) -> String {
    let mut text = String::from("# time_s x_m y_m z_m qx qy qz qw\n");
    for TimedPose { time_s, place_m, rotation } in trajectory {
        let [x, y, z, w] = rotation.coords.into();
        let place = format_args!("{:.6} {:.6} {:.6}", place_m.x, place_m.y, place_m.z);
        // Writing to a string cannot fail.
        let _ = writeln!(text, "{time_s:.6} {place} {x:.9} {y:.9} {z:.9} {w:.9}");
    }
    text
}

/// The pose at a time between two of a trajectory, the turn along the shortest way; `None` before the first one, after the last one, and in
/// a gap longer than `gap_s`.
#[must_use]
pub fn pose_at(trajectory: &[TimedPose], time_s: f64, gap_s: f64) -> Option<TimedPose> {
    let after = trajectory.partition_point(|pose| pose.time_s < time_s);
    let next = trajectory.get(after)?;
    let Some(before) = after.checked_sub(1).and_then(|before| trajectory.get(before)) else {
        return (next.time_s <= time_s).then_some(*next);
    };
    let passed_s = next.time_s - before.time_s;
    let share = (time_s - before.time_s) / passed_s;
    let rotation = before.rotation.try_slerp(&next.rotation, share, 1.0e-12).unwrap_or(next.rotation);
    (passed_s <= gap_s).then(|| TimedPose {
        time_s,
        place_m: before.place_m.lerp(&next.place_m, share),
        rotation,
    })
}

impl TimedPose {
    /// On the floor: place and heading.
    #[must_use]
    pub fn flat(&self) -> Se2 {
        let ahead = self.rotation * Vector3::x();
        Se2::new(self.place_m.x, self.place_m.y, libm::atan2(ahead.y, ahead.x))
    }
}
