//! What a mission is run with: strategy, robot, belief, and what goes wrong.

use floorguard_cleaning::{ActuatorModel, BeliefConfig, Brush, Collapse, DirtSensorModel};
use floorguard_localisation::{MotionNoise, RangeModelConfig};
use floorguard_navigation::FollowConfig;

use super::faults::FaultRates;
use super::truth::RangeSensor;

/// How the robot decides where to clean.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, clap::ValueEnum)]
pub enum Strategy {
    /// Visits the cells of the policy and plans again until the belief says that all are clean.
    Guarantee,
    /// One tour over the cells that were dirty at the start.
    NoReplanning,
    /// Lanes over the whole floor.
    Systematic,
    /// Straight on until there is an obstacle, then any other direction.
    Random,
}

impl Strategy {
    /// The name on the command line.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Guarantee => "guarantee",
            Self::NoReplanning => "no-replanning",
            Self::Systematic => "systematic",
            Self::Random => "random",
        }
    }
}

/// What holds with a confidence of 1 − δ.
#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum)]
pub enum Guarantee {
    /// Each dirty cell holds at most τ, one by one: the published rule. Of many cells some fail.
    EachCell,
    /// The 99 % quantile over the dirty cells is at most τ: the mission succeeds.
    Mission,
    /// All dirty cells hold at most τ at once.
    AllCells,
}

/// The robot.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Robot {
    /// Radius, metres.
    pub radius_m: f32,
    /// Brush.
    pub brush: Brush,
    /// Speeds.
    pub follow: FollowConfig,
    /// Range sensor.
    pub sensor: RangeSensor,
    /// What the belief assumes of it.
    pub range: RangeModelConfig,
}

impl Robot {
    /// The published robot: a small round one with a depth camera (book, Cleaning: Published protocol).
    pub const PUBLISHED: Self = Self {
        radius_m: 0.17,
        brush: Brush { width_m: 0.17, offset_m: 0.0 },
        follow: FollowConfig::ROOMBA,
        sensor: RangeSensor::XTION,
        range: RangeModelConfig::XTION,
    };
    /// The same base with a safety scanner, for work among people and with faults.
    pub const WITH_SCANNER: Self = Self {
        sensor: RangeSensor::SAFETY_SCANNER,
        range: RangeModelConfig::SAFETY_SCANNER,
        ..Self::PUBLISHED
    };
}

/// A mission.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MissionConfig {
    /// How the robot decides.
    pub strategy: Strategy,
    /// Units that may stay in a clean cell, τ.
    pub tolerated_units: u8,
    /// Probability with which a cell called clean may hold more, δ.
    pub delta: f64,
    /// Probability with which a mission may miss its criterion; for [`Guarantee::Mission`].
    pub mission_risk: f64,
    /// What is promised.
    pub guarantee: Guarantee,
    /// The clean rule uses the mean alone, and particles collapse to a Poisson law, as published.
    pub as_published: bool,
    /// The robot.
    pub robot: Robot,
    /// How the belief models the brush.
    pub actuator: ActuatorModel,
    /// Share that a pass picks up, as the belief assumes.
    pub assumed_pickup: f32,
    /// Share that a pass picks up in truth.
    pub true_pickup: f32,
    /// The belief uses the dirt sensor.
    pub uses_dirt_sensor: bool,
    /// People on the floor.
    pub people: usize,
    /// What goes wrong.
    pub faults: FaultRates,
    /// Distance after which the random strategy ends, metres.
    pub distance_limit_m: Option<f32>,
}

impl MissionConfig {
    /// The published settings with a strategy.
    pub const fn published(strategy: Strategy) -> Self {
        Self {
            strategy,
            tolerated_units: 5,
            delta: 0.01,
            mission_risk: 0.01,
            guarantee: Guarantee::EachCell,
            as_published: false,
            robot: Robot::PUBLISHED,
            actuator: ActuatorModel::PassCoverage,
            assumed_pickup: 0.9,
            true_pickup: 0.9,
            uses_dirt_sensor: true,
            people: 0,
            faults: FaultRates { slips: 0.0, jumps: 0.0, outages: 0.0, resets: 0.0 },
            distance_limit_m: None,
        }
    }

    /// Parameters of the belief.
    pub fn belief(&self) -> BeliefConfig {
        BeliefConfig {
            brush: self.robot.brush,
            pickup_probability: self.assumed_pickup,
            actuator: self.actuator,
            collapse: if self.as_published { Collapse::Poisson } else { Collapse::Mixture },
            dirt_sensor: DirtSensorModel::default(),
            motion: MotionNoise::MEASURED,
            range: self.robot.range,
            tolerated_units: self.tolerated_units,
            recovery_particles: if self.faults.are_zero() { None } else { Some((0.12, 0.1)) },
            resample_always: self.as_published,
        }
    }
}
