//! A base that takes velocities, as its maker would build it: written from the book, Velocity link, alone.
//!
//! It drives what the newest request says until that request's deadline, ramps up and down by itself, and reports what it
//! measures. It trusts nothing but whole frames in order.

use floorguard_types::geometry::Twist2;

use crate::wire::{TakenVelocity, motion_report};

/// How fast it changes its speed, m/s²: as steep as the ramps of the simulated drives.
const RAMP_MPS2: f32 = 1.4;
/// How fast it changes its turning rate, rad/s².
const TURN_RAMP_RADPS2: f32 = 2.0;

/// The controller of a base.
#[derive(Clone, Debug, Default)]
pub struct VelocityBase {
    newest: Option<TakenVelocity>,
    /// From then on it stands, microseconds.
    ends_us: u64,
    driven: Twist2,
    reports: u32,
    stepped_us: u64,
    /// Requests that were taken.
    pub taken: u32,
}

impl VelocityBase {
    /// A frame of the robot's computer.
    pub fn receive(&mut self, bytes: &[u8], now_us: u64) {
        let Some(request) = TakenVelocity::read(bytes) else { return };
        let is_newer =
            self.newest.is_none_or(|newest| request.sequence.wrapping_sub(newest.sequence) < 1 << 31);
        if is_newer {
            self.ends_us = now_us + u64::from(request.deadline_ms) * 1_000;
            self.newest = Some(request);
            self.taken += 1;
        }
    }

    /// What it drives now: forward in m/s, counter-clockwise in rad/s.
    pub fn step(&mut self, now_us: u64) -> Twist2 {
        let step_s = now_us.saturating_sub(self.stepped_us) as f32 * 1.0e-6;
        self.stepped_us = now_us;
        let target = match self.newest {
            Some(request) if now_us < self.ends_us && request.stop == 0 => request.velocity,
            _ => [0.0; 2],
        };
        let ramp = |from: f32, to: f32, rate: f32| from + (to - from).clamp(-rate * step_s, rate * step_s);
        self.driven = Twist2 {
            linear_mps: ramp(self.driven.linear_mps, target[0], RAMP_MPS2),
            angular_radps: ramp(self.driven.angular_radps, target[1], TURN_RAMP_RADPS2),
        };
        self.driven
    }

    /// A report of the true motion.
    pub fn report(&mut self, measured: Twist2, age_ms: u16) -> Vec<u8> {
        self.reports += 1;
        let is_off = self.newest.is_none_or(|request| request.stop == 3);
        let state = if is_off { 1 } else { 2 };
        motion_report((self.reports, age_ms), state, [measured.linear_mps, measured.angular_radps])
    }
}
