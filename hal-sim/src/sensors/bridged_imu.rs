//! Any inertial sensor behind a bridge: a hundred samples a second, one a frame (book, IMU link).

use floorguard_types::random::Pcg32;

use super::imu::Motion;
use crate::wire::imu_link_frame;

const PERIOD_US: u64 = 10_000;
/// From power to the first sample: the sensor, and the program that is started anew.
const BOOT_US: u64 = 400_000;
const GRAVITY_MPS2: f32 = 9.81;

/// The sensor and its bridge.
#[derive(Clone, Debug)]
pub struct BridgedImu {
    next_us: u64,
    clock_offset_us: u64,
    sender: u32,
    sequence: u32,
    bias_radps: f32,
    random: Pcg32,
}

impl BridgedImu {
    /// Switched on at time 0.
    #[must_use]
    pub fn new(seed: u64) -> Self {
        let mut random = Pcg32::new(seed, 13);
        let bias_radps = random.normal() * 0.002;
        Self {
            next_us: 0,
            clock_offset_us: u64::from(random.below(3_000_000)) * 1_000,
            sender: random.below(u32::MAX) | 1,
            sequence: 0,
            bias_radps,
            random,
        }
    }

    /// Switched off and on again: starts after `off_us`, as another sender that counts from the beginning.
    pub fn power_cycle(&mut self, now_us: u64, off_us: u64) {
        self.next_us = self.next_us.max(now_us + off_us + BOOT_US).next_multiple_of(PERIOD_US);
        (self.sender, self.sequence) = (self.random.below(u32::MAX) | 1, 0);
    }

    /// The bias of the gyroscope about the vertical, counter-clockwise, rad/s.
    #[must_use]
    pub const fn bias_radps(&self) -> f32 {
        self.bias_radps
    }

    /// When the next sample is due, microseconds.
    #[must_use]
    pub const fn due_us(&self) -> u64 {
        self.next_us
    }

    /// One sampling instant; what is sent.
    pub fn sample(&mut self, now_us: u64, motion: Motion) -> Option<Vec<u8>> {
        self.next_us += PERIOD_US;
        let noise = [self.random.normal_pair(), self.random.normal_pair(), self.random.normal_pair()];
        let rates =
            [0.003 * noise[1].1, 0.003 * noise[2].0, motion.yaw_radps + self.bias_radps + 0.003 * noise[2].1];
        let accelerations = [
            motion.forward_mps2 + 0.02 * noise[0].0,
            motion.left_mps2 + 0.02 * noise[0].1,
            GRAVITY_MPS2 + 0.02 * noise[1].0,
        ];
        let sequence = self.sequence;
        self.sequence = self.sequence.wrapping_add(1);
        let measured_us = self.clock_offset_us + now_us;
        Some(imu_link_frame((self.sender, sequence), (measured_us, 0), &[(rates, accelerations, 0)]))
    }
}
