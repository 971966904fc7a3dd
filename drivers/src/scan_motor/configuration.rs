//! Which node, which gear, and between which limits it turns.

use core::f32::consts::TAU;

use floorguard_types::number::{nearest_f32, saturating_i32, saturating_u32};

use crate::canopen::Script;

/// Profile velocity (CiA 402).
const PROFILE_VELOCITY: u32 = 3;
/// Transmission with each SYNC.
const EACH_SYNC: u8 = 1;
/// Heartbeat of the node, milliseconds.
const HEARTBEAT_MS: u32 = 100;

/// The motor.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ScanMotorConfiguration {
    /// On the bus, 1…127.
    pub node: u8,
    /// Counts of the encoder for a turn of the lidar, gear included; negative where the motor turns the other way.
    pub counts_per_turn: f32,
    /// Turns of the motor for a turn of the lidar, > 0: velocities are commanded in turns of the motor a minute.
    pub gear: f32,
    /// Counts where the lidar looks straight ahead.
    pub ahead_counts: i32,
    /// It turns to here, radians, left positive, and back.
    pub left_rad: f32,
    /// And to here, less than `left_rad`.
    pub right_rad: f32,
    /// How fast, radians a second, > 0.
    pub speed_radps: f32,
    /// How fast it reverses, radians a second squared, > 0.
    pub ramp_radps2: f32,
}

impl ScanMotorConfiguration {
    /// ±112.5° at 0.3 rad/s (Dalmedico et al. 2019); a gear of 1:100 and an encoder of 512 lines, which were not published.
    pub const PUBLISHED: Self = Self {
        node: 11,
        counts_per_turn: 204_800.0,
        gear: 100.0,
        ahead_counts: 0,
        left_rad: 1.963_495,
        right_rad: -1.963_495,
        speed_radps: 0.3,
        ramp_radps2: 3.0,
    };

    /// All numbers are finite, limits in order, speeds positive.
    #[must_use]
    pub fn is_plausible(&self) -> bool {
        let is_finite = [self.counts_per_turn, self.gear, self.left_rad, self.right_rad]
            .iter()
            .all(|one| one.is_finite());
        is_finite
            && (1..=127).contains(&self.node)
            && self.counts_per_turn.abs() >= 256.0
            && (0.01..=10_000.0).contains(&self.gear)
            && self.right_rad < self.left_rad
            && (0.01..=20.0).contains(&self.speed_radps)
            && (0.01..=1_000.0).contains(&self.ramp_radps2)
    }

    /// The lidar's angle of a count of the encoder, radians.
    #[must_use]
    pub fn angle_rad(&self, counts: i32) -> f32 {
        // Plausible counts a turn are not 0.
        nearest_f32(counts.wrapping_sub(self.ahead_counts)) * (TAU / self.counts_per_turn)
    }

    /// The velocity to command, turns of the motor a minute.
    #[must_use]
    pub fn motor_rpm(&self, speed_radps: f32) -> i32 {
        let way = if self.counts_per_turn < 0.0 { -1.0 } else { 1.0 };
        saturating_i32(libm::roundf(way * speed_radps * self.gear * (60.0 / TAU)))
    }

    /// What is written to the node before it starts: mode, ramps, and process data with each SYNC.
    #[must_use]
    pub fn script(&self) -> Script {
        let ramp = saturating_u32(libm::roundf(self.ramp_radps2 * self.gear * (60.0 / TAU))).max(1);
        Script::new()
            .write(0x1017, 0, HEARTBEAT_MS, 2)
            .write(0x6060, 0, PROFILE_VELOCITY, 1)
            .write(0x6083, 0, ramp, 4)
            .write(0x6084, 0, ramp, 4)
            .write(0x60FF, 0, 0, 4)
            .transmit(self.node, 0, (EACH_SYNC, &[0x6041_0010, 0x6064_0020]))
            .receive(self.node, 0, (255, &[0x6040_0010, 0x60FF_0020]))
    }
}
