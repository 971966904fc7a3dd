//! Devices that do otherwise than commanded, or measure otherwise than it is.

use crate::robot::RobotBody;
use crate::scenario::{RunawayFile, Scenario, TurningGyroscopeFile};

/// What of the robot is broken.
#[derive(Clone, Debug)]
pub(super) struct BrokenDevices {
    runaway: Option<RunawayFile>,
    turning_gyroscope: Option<TurningGyroscopeFile>,
    encoder_gains: Vec<f32>,
}

impl BrokenDevices {
    /// As the scenario says.
    pub fn of(scenario: &Scenario) -> Self {
        Self {
            runaway: scenario.runaway,
            turning_gyroscope: scenario.turning_gyroscope,
            encoder_gains: scenario.encoder_gains.clone(),
        }
    }

    /// Encoders that count something else than their wheels roll.
    pub fn break_encoders(&self, body: &mut RobotBody) {
        body.encoder_gains.iter_mut().zip(&self.encoder_gains).for_each(|(gain, broken)| *gain = *broken);
    }

    /// Drives that turn faster than commanded, if it is time.
    pub fn break_drives(&self, body: &mut RobotBody, now_us: u64) {
        let Some(runaway) = self.runaway.filter(|drives| has_come(now_us, drives.from_s)) else { return };
        body.drive_gain = runaway.gain;
        body.feedback_gain = if runaway.is_hidden { 1.0 / runaway.gain } else { 1.0 };
    }

    /// What a broken gyroscope adds, rad/s.
    pub fn false_turn_radps(&self, now_us: u64) -> f32 {
        let turning = self.turning_gyroscope.filter(|gyroscope| has_come(now_us, gyroscope.from_s));
        turning.map_or(0.0, |gyroscope| gyroscope.turn_radps)
    }
}

/// A moment in seconds has come.
fn has_come(now_us: u64, from_s: f32) -> bool {
    now_us as f32 * 1.0e-6 >= from_s
}
