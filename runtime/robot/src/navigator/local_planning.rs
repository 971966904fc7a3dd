//! What the navigator's local planners are made of, for a program that lets them drive without the rest of the robot.
//!
//! An experiment that had parameters of its own would judge another robot.

use floorguard_navigation::costmap::PeopleCost;
use floorguard_navigation::local::{DwaConfig, MppiConfig};
use floorguard_runtime::configuration::RobotConfiguration;
use floorguard_types::motion::{DriveKinematics, Footprint};

use super::maps::HILLS;
use super::model::{Model, PERIOD_S};
use super::plan::NavigationSettings;
use super::steering::SAMPLES;

/// Outline, drive and parameters of a robot's local planners.
#[derive(Clone, Debug)]
pub struct LocalPlanning {
    /// The outline with its margin.
    pub outline: Footprint,
    /// How it moves.
    pub drive: DriveKinematics,
    /// Parameters of ours.
    pub mppi: MppiConfig,
    /// Samples of ours.
    pub samples: usize,
    /// Parameters of the dynamic window.
    pub dwa: DwaConfig,
    /// The hills by which the dynamic window knows people.
    pub hills: PeopleCost,
    /// From command to command, seconds.
    pub period_s: f32,
}

impl LocalPlanning {
    /// Of a robot that is to drive like this, on cells of this edge.
    ///
    /// # Errors
    /// The base point lies outside the outline.
    pub fn of(
        robot: &RobotConfiguration,
        settings: &NavigationSettings,
        cell_m: f32,
    ) -> anyhow::Result<Self> {
        let model = Model::of(robot, settings, cell_m)?;
        let (mppi, dwa) = (model.mppi(), model.dwa());
        let Model { outline, drive, .. } = model;
        Ok(Self { outline, drive, mppi, samples: SAMPLES, dwa, hills: HILLS, period_s: PERIOD_S })
    }
}
