//! Where the sensor was at every time.

use floorguard_types::geometry::{Point3, Transform3};
use nalgebra::{UnitQuaternion, Vector3};

use crate::metrics::TimedPose;
use crate::turn::{turn_about, turn_vector};

/// Poses of the sensor in the map, ordered by time.
#[derive(Clone, Debug, PartialEq)]
pub struct Track {
    poses: Vec<TimedPose>,
}

/// Why poses are no track.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum TrackError {
    /// There is none.
    #[error("the trajectory holds no pose")]
    Empty,
    /// Two poses have the same time or come in the wrong order.
    #[error("pose {number} of the trajectory, at {time_s} s, is not later than the one before")]
    NotLater {
        /// From 1.
        number: usize,
        /// Its time.
        time_s: f64,
    },
    /// The graph of the drive's poses and loops has no solution.
    #[error("the loops of the drive contradict each other; clean it with --poses of another program")]
    Unsolvable,
}

/// Times may lie this much outside of the track, seconds: the first and the last sweep are a little longer than it.
const OUTSIDE_MAX_S: f64 = 0.15;
/// Poses farther apart say nothing about the time between, seconds.
const GAP_MAX_S: f64 = 0.5;

impl Track {
    /// From poses in the order of their times.
    ///
    /// # Errors
    /// See [`TrackError`].
    pub fn new(poses: Vec<TimedPose>) -> Result<Self, TrackError> {
        if poses.is_empty() {
            return Err(TrackError::Empty);
        }
        for (index, pair) in poses.windows(2).enumerate() {
            if pair[1].time_s <= pair[0].time_s {
                return Err(TrackError::NotLater { number: index + 2, time_s: pair[1].time_s });
            }
        }
        Ok(Self { poses })
    }

    /// A sensor that stands still at the origin of its map, for as long as anything is recorded.
    #[must_use]
    pub fn standing() -> Self {
        let rest =
            |time_s| TimedPose { time_s, place_m: Vector3::zeros(), rotation: UnitQuaternion::identity() };
        Self { poses: vec![rest(f64::NEG_INFINITY), rest(f64::INFINITY)] }
    }

    /// The poses, ordered by time.
    #[must_use]
    pub fn poses(&self) -> &[TimedPose] {
        &self.poses
    }

    /// Times of the first and the last pose, seconds.
    #[must_use]
    pub fn span_s(&self) -> [f64; 2] {
        [self.poses[0].time_s, self.poses[self.poses.len() - 1].time_s]
    }

    /// The pose at a time, along the chord and the shortest turn; `None` more than 0.15 s outside of the track, and in gaps of more
    /// than 0.5 s.
    #[must_use]
    pub fn at(&self, time_s: f64) -> Option<Transform3> {
        let after = self.poses.partition_point(|pose| pose.time_s <= time_s);
        let second = after.clamp(1, self.poses.len().max(2) - 1);
        let (Some(from), to) = (self.poses.get(second - 1), self.poses.get(second)) else { return None };
        let Some(to) = to else {
            return ((time_s - from.time_s).abs() <= OUTSIDE_MAX_S)
                .then(|| transform(from.place_m, from.rotation));
        };
        if from.time_s.is_infinite() {
            return Some(transform(from.place_m, from.rotation));
        }
        let gap_s = to.time_s - from.time_s;
        let outside_s = (from.time_s - time_s).max(time_s - to.time_s);
        if gap_s > GAP_MAX_S || outside_s > OUTSIDE_MAX_S {
            return None;
        }
        let share = (time_s - from.time_s) / gap_s;
        let place = from.place_m + share * (to.place_m - from.place_m);
        let turn = turn_vector(&from.rotation.rotation_to(&to.rotation)) * share;
        Some(transform(place, turn_about(&turn) * from.rotation))
    }
}

fn transform(place: Vector3<f64>, rotation: UnitQuaternion<f64>) -> Transform3 {
    let matrix = rotation.to_rotation_matrix();
    let row = |index: usize| [0, 1, 2].map(|column| matrix[(index, column)] as f32);
    Transform3 {
        rotation: [row(0), row(1), row(2)],
        translation: Point3::new(place.x as f32, place.y as f32, place.z as f32),
    }
}
