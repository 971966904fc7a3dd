//! Whichever inertial sensor the robot carries.

use super::bridged_imu::BridgedImu;
use super::imu::{Imu, Motion};
use super::vectornav::VectorNav;
use crate::robot::ImuDevice;

/// One of them.
// One lives for the length of a run.
#[allow(clippy::large_enum_variant)]
#[derive(Clone, Debug)]
pub enum ImuSensor {
    /// Xsens MTi.
    Xsens(Imu),
    /// VectorNav VN-100.
    VectorNav(VectorNav),
    /// Any sensor behind a bridge.
    Bridged(BridgedImu),
}

impl ImuSensor {
    /// Switched on at time 0.
    #[must_use]
    pub fn new(device: ImuDevice, seed: u64) -> Self {
        match device {
            ImuDevice::XsensMti => Self::Xsens(Imu::new(seed)),
            ImuDevice::VectorNav => Self::VectorNav(VectorNav::new(seed)),
            ImuDevice::Bridged => Self::Bridged(BridgedImu::new(seed)),
        }
    }

    /// Switched off and on again: starts after `off_us`.
    pub fn power_cycle(&mut self, now_us: u64, off_us: u64) {
        match self {
            Self::Xsens(imu) => imu.power_cycle(now_us, off_us),
            Self::VectorNav(imu) => imu.power_cycle(now_us, off_us),
            Self::Bridged(imu) => imu.power_cycle(now_us, off_us),
        }
    }

    /// The bias of the gyroscope about the vertical, counter-clockwise, rad/s: what a filter should find.
    #[must_use]
    pub const fn bias_radps(&self) -> f32 {
        match self {
            Self::Xsens(imu) => imu.bias_radps(),
            Self::VectorNav(imu) => imu.bias_radps(),
            Self::Bridged(imu) => imu.bias_radps(),
        }
    }

    /// When the next sample is due, microseconds.
    #[must_use]
    pub const fn due_us(&self) -> u64 {
        match self {
            Self::Xsens(imu) => imu.due_us(),
            Self::VectorNav(imu) => imu.due_us(),
            Self::Bridged(imu) => imu.due_us(),
        }
    }

    /// One sampling instant; what goes on the line.
    pub fn sample(&mut self, now_us: u64, motion: Motion) -> Option<Vec<u8>> {
        match self {
            Self::Xsens(imu) => imu.sample(now_us, motion),
            Self::VectorNav(imu) => imu.sample(now_us, motion),
            Self::Bridged(imu) => imu.sample(now_us, motion),
        }
    }

    /// Takes bytes from the host; the answers.
    pub fn receive(&mut self, bytes: &[u8], now_us: u64) -> Vec<u8> {
        match self {
            Self::Xsens(imu) => imu.receive(bytes, now_us),
            Self::VectorNav(imu) => imu.receive(bytes, now_us),
            // A bridge takes nothing.
            Self::Bridged(_) => Vec::new(),
        }
    }
}
