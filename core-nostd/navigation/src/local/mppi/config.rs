//! Parameters of the predictive controller.

use floorguard_types::motion::DriveKinematics;

use crate::local::Arrival;

/// Steps of a sample.
pub const MPPI_STEPS: usize = 30;

/// What is better than what; everything is counted in seconds, so that a weight is a rate of exchange.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MppiWeights {
    /// A second beside an obstacle at the highest cost of the costmap, seconds.
    pub nearness: f32,
    /// A second in the middle of a person's place, seconds.
    pub person: f32,
    /// Touching something, seconds.
    pub collision: f32,
    /// Every stop by the guard, seconds; the time for which the robot is held counts by itself.
    pub held: f32,
    /// Off the path at the end, seconds for a metre.
    pub off_path: f32,
    /// Heading away from the path at the end, seconds for a radian.
    pub heading: f32,
    /// Changes of the requested speed, seconds for (m/s)².
    pub speed_change: f32,
    /// Changes of the requested turning rate, seconds for (rad/s)².
    pub turn_change: f32,
    /// A second of driving backwards, seconds.
    pub reverse: f32,
}

impl MppiWeights {
    /// Chosen on simulated worlds, see the figures of the benchmark in `tests/src/barn`.
    pub const DEFAULT: Self = Self {
        nearness: 0.6,
        person: 6.0,
        collision: 40.0,
        held: 1.0,
        off_path: 0.8,
        heading: 0.15,
        speed_change: 0.02,
        turn_change: 0.02,
        reverse: 0.6,
    };
}

/// The controller's parameters.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MppiConfig {
    /// What the drive can do.
    pub drive: DriveKinematics,
    /// From step to step of a sample, seconds, > 0.
    pub step_s: f32,
    /// From command to command, seconds, > 0.
    pub period_s: f32,
    /// Standard deviation of the tried speeds, m/s.
    pub speed_noise_mps: f32,
    /// Standard deviation of the tried turning rates, rad/s.
    pub turn_noise_radps: f32,
    /// Samples that are this much worse than the best count e times less, seconds, > 0.
    pub temperature_s: f32,
    /// Below this cost nothing touches the circumscribed disc of the robot: its outline need not be examined.
    pub clear_cost: u8,
    /// Unannounced acceleration of people, m/s² (a standard deviation).
    pub people_acceleration_mps2: f32,
    /// Radius of a person, metres.
    pub person_radius_m: f32,
    /// How the path ends.
    pub arrival: Arrival,
    /// What is better than what.
    pub weights: MppiWeights,
}
