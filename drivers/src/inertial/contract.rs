//! What every inertial sensor does: it is brought to measure, and measures.

use floorguard_types::sensing::ImuSample;
use floorguard_types::time::Stamp;

use crate::{imu_link, vectornav, xsens};

/// What a sensor reports.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum InertialEvent {
    /// A sample, in the sensor's own axes.
    Sample(ImuSample),
    /// A message of no use.
    Refused,
    /// It reports an error: the code of its maker.
    Error(u8),
}

/// Why a sensor that talks is not as it should be.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum InertialFault {
    /// Of an Xsens MTi.
    Xsens(xsens::DeviceFault),
    /// Of a VectorNav.
    VectorNav(vectornav::DeviceFault),
    /// Of a sensor behind a bridge.
    Bridged(imu_link::DeviceFault),
}

impl core::fmt::Display for InertialFault {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        match self {
            Self::Xsens(fault) => fault.fmt(f),
            Self::VectorNav(fault) => fault.fmt(f),
            Self::Bridged(fault) => fault.fmt(f),
        }
    }
}

impl core::error::Error for InertialFault {}

/// Bytes in, samples out; requests between them.
pub trait InertialSensor {
    /// Takes bytes that arrived at a time.
    fn take(&mut self, bytes: &[u8], now: Stamp, event: &mut impl FnMut(InertialEvent));

    /// Time has passed: sends what is due, at most 64 bytes.
    fn request(&mut self, now: Stamp, send: &mut impl FnMut(&[u8]));

    /// What is wrong with it, as of the newest start-up.
    fn complaint(&self) -> Option<InertialFault>;
}

impl InertialSensor for xsens::Device {
    fn take(&mut self, bytes: &[u8], now: Stamp, event: &mut impl FnMut(InertialEvent)) {
        self.push(bytes, now, |found| match found {
            xsens::DeviceEvent::Sample(sample) => event(InertialEvent::Sample(sample)),
            xsens::DeviceEvent::Refused(_) => event(InertialEvent::Refused),
            xsens::DeviceEvent::Error(code) => event(InertialEvent::Error(code)),
            xsens::DeviceEvent::OtherConfiguration => {}
        });
    }

    fn request(&mut self, now: Stamp, send: &mut impl FnMut(&[u8])) {
        self.poll(now, send);
    }

    fn complaint(&self) -> Option<InertialFault> {
        self.fault().map(InertialFault::Xsens)
    }
}

impl InertialSensor for vectornav::Device {
    fn take(&mut self, bytes: &[u8], now: Stamp, event: &mut impl FnMut(InertialEvent)) {
        self.push(bytes, now, |found| match found {
            vectornav::DeviceEvent::Sample(sample) => event(InertialEvent::Sample(sample)),
            vectornav::DeviceEvent::Refused => event(InertialEvent::Refused),
            vectornav::DeviceEvent::Error(code) => event(InertialEvent::Error(code)),
        });
    }

    fn request(&mut self, now: Stamp, send: &mut impl FnMut(&[u8])) {
        self.poll(now, send);
    }

    fn complaint(&self) -> Option<InertialFault> {
        self.fault().map(InertialFault::VectorNav)
    }
}

impl InertialSensor for imu_link::Device {
    fn take(&mut self, bytes: &[u8], now: Stamp, event: &mut impl FnMut(InertialEvent)) {
        self.push(bytes, now, |found| match found {
            imu_link::DeviceEvent::Sample(sample) => event(InertialEvent::Sample(sample)),
            imu_link::DeviceEvent::Refused => event(InertialEvent::Refused),
            imu_link::DeviceEvent::Error(code) => event(InertialEvent::Error(code)),
        });
    }

    /// A bridge sends by itself.
    fn request(&mut self, _: Stamp, _: &mut impl FnMut(&[u8])) {}

    fn complaint(&self) -> Option<InertialFault> {
        self.fault().map(InertialFault::Bridged)
    }
}
