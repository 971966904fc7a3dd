//! The velocities within reach, sampled evenly (ROS `base_local_planner`, `VelocityIterator`).

use super::dwa_config::DwaConfig;

/// Samples of one axis at most; zero may come beside them.
const SAMPLES_MAX: u8 = 64;

/// Limits of one axis.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SampleAxis {
    /// Smallest velocity.
    pub min: f32,
    /// Largest velocity, ≥ the smallest.
    pub max: f32,
    /// How many samples, both ends included.
    pub count: u8,
}

/// Speeds and turning rates that can be reached within one period, clipped to the limits.
#[must_use]
pub fn window(config: &DwaConfig, speed_mps: f32, turn_radps: f32, speed_limit_mps: f32) -> [SampleAxis; 2] {
    let (change_mps, change_radps) =
        (config.acceleration_mps2 * config.period_s, config.turn_acceleration_radps2 * config.period_s);
    let top_mps = config.speed_max_mps.min(speed_limit_mps);
    let max_mps = top_mps.min(speed_mps + change_mps).max(config.speed_min_mps);
    let max_radps = config.turn_max_radps.min(turn_radps + change_radps);
    let speed = SampleAxis {
        min: config.speed_min_mps.max(speed_mps - change_mps).min(max_mps),
        max: max_mps,
        count: config.speed_samples,
    };
    let turn = SampleAxis {
        min: (-config.turn_max_radps).max(turn_radps - change_radps).min(max_radps),
        max: max_radps,
        count: config.turn_samples,
    };
    [speed, turn]
}

/// The samples of an axis in ascending order: evenly from end to end, and 0 where the axis passes it between two samples.
pub fn samples(axis: SampleAxis) -> impl Iterator<Item = f32> + Clone {
    let is_one = axis.max - axis.min <= 0.0 || axis.count < 2;
    let count = if is_one { 1 } else { axis.count.min(SAMPLES_MAX) };
    let step = if is_one { 0.0 } else { (axis.max - axis.min) / f32::from(count.saturating_sub(1)) };
    let at = move |index: u8| {
        if index.saturating_add(1) == count { axis.max } else { axis.min + f32::from(index) * step }
    };
    (0..count).flat_map(move |index| {
        let value = at(index);
        let passes_zero = index > 0 && at(index.saturating_sub(1)) < 0.0 && value > 0.0;
        passes_zero.then_some(0.0).into_iter().chain([value])
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::vec::Vec;

    #[test]
    fn the_window_is_what_one_period_reaches() {
        let config = DwaConfig::PUBLISHED;
        let [speed, turn] = window(&config, 0.3, 0.0, f32::INFINITY);
        assert!((speed.min - 0.175).abs() < 1e-6 && (speed.max - 0.425).abs() < 1e-6);
        assert!((turn.min + 0.16).abs() < 1e-6 && (turn.max - 0.16).abs() < 1e-6);
        let [speed, turn] = window(&config, 0.5, 0.95, f32::INFINITY);
        assert!((speed.max - 0.55).abs() < 1e-6 && (turn.max - 1.0).abs() < 1e-6);
        let [speed, _] = window(&config, 0.5, 0.0, 0.1);
        assert!(speed.min <= speed.max && speed.max <= 0.1 + 1e-6);
    }

    #[test]
    fn zero_comes_in_where_the_axis_passes_it() {
        let all: Vec<f32> = samples(SampleAxis { min: -0.3, max: 0.1, count: 3 }).collect();
        assert_eq!(all.len(), 4);
        assert_eq!((all[0], all[2], all[3]), (-0.3, 0.0, 0.1));
        assert!((all[1] + 0.1).abs() < 1e-6);
        assert_eq!(samples(SampleAxis { min: 0.2, max: 0.2, count: 3 }).collect::<Vec<_>>(), [0.2]);
        // The published size of the search: 3 speeds (the axis begins at 0) × 21 rates.
        let rates = samples(SampleAxis { min: -0.16, max: 0.16, count: 20 }).count();
        assert_eq!(rates, 21);
    }
}
