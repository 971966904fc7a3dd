//! The belief of the scrubber that drives: a large robot with a wide brush and a safety scanner.

use floorguard_cleaning::{ActuatorModel, BeliefConfig, Brush, Collapse, DirtSensorModel};
use floorguard_localisation::{MotionNoise, RangeModelConfig};

/// The scrubbing deck (FLOBOT's), a bar across the robot, ahead of the rear axle.
pub const BRUSH: Brush = Brush { width_m: 0.65, offset_m: 0.25 };

/// Parameters of the belief. Recovery particles are always on: wheels slip on a floor that is being wetted.
#[must_use]
pub fn belief(tolerated_units: u8) -> BeliefConfig {
    BeliefConfig {
        brush: BRUSH,
        pickup_probability: 0.9,
        actuator: ActuatorModel::PassCoverage,
        collapse: Collapse::Mixture,
        dirt_sensor: DirtSensorModel::default(),
        motion: MotionNoise::MEASURED,
        range: RangeModelConfig::SAFETY_SCANNER,
        tolerated_units,
        recovery_particles: Some((0.12, 0.1)),
        resample_always: false,
    }
}
