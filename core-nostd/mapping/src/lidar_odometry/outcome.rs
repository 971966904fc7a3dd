//! What became of a sweep.

use nalgebra::{Matrix6, Vector3};

use super::filter::MotionState;

/// The direction in which the place is known worst.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct WeakDirection {
    /// Unit vector in the sensor's axes.
    pub direction: Vector3<f64>,
    /// Standard deviation along it after the sweep, in the map of the first one, metres.
    pub deviation_m: f64,
    /// The returns say nothing about one direction of the place: the prediction (and wheels) hold it.
    pub is_held_by_prediction: bool,
}

/// Pose at the end of a sweep, and how it came about.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SweepOutcome {
    /// Pose and velocity at the end of the sweep; its covariance takes the map as exact.
    pub state: MotionState,
    /// Covariance of the pose in the map of the first sweep, in the sensor's axes (rotation, place): grows where new surfaces
    /// are mapped and where the returns say nothing.
    pub drift: Matrix6<f64>,
    /// Averaged returns of the sweep.
    pub returns: u32,
    /// Those that lay on a known plane.
    pub matched: u32,
    /// Averaged returns for which there was no place.
    pub dropped: u32,
    /// Mean distance from the planes in deviations: about 1 where all is well.
    pub misfit: f64,
    /// What the returns say about the weakest direction of the place, in multiples of what noise would say: below 150 nothing,
    /// some hundreds in a corridor with doors, thousands in a furnished room.
    pub times_noise: f64,
    /// Worst direction.
    pub weak: WeakDirection,
    /// Too few returns lay on the map: the pose is a prediction.
    pub is_blind: bool,
    /// The sweep was entered into the map.
    pub is_mapped: bool,
}
