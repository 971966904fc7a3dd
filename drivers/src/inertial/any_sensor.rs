//! Whichever sensor is configured.

use floorguard_types::time::Stamp;

use super::contract::{InertialEvent, InertialFault, InertialSensor};
use crate::{imu_link, vectornav, xsens};

/// One of the makers' protocols.
// One lives for the length of a run.
#[allow(clippy::large_enum_variant)]
#[derive(Clone, Debug)]
pub enum AnyInertialSensor {
    /// Xsens MTi.
    Xsens(xsens::Device),
    /// VectorNav VN-100, VN-200 or VN-300.
    VectorNav(vectornav::Device),
    /// Any sensor behind a bridge.
    Bridged(imu_link::Device),
}

impl InertialSensor for AnyInertialSensor {
    fn take(&mut self, bytes: &[u8], now: Stamp, event: &mut impl FnMut(InertialEvent)) {
        match self {
            Self::Xsens(device) => device.take(bytes, now, event),
            Self::VectorNav(device) => device.take(bytes, now, event),
            Self::Bridged(device) => device.take(bytes, now, event),
        }
    }

    fn request(&mut self, now: Stamp, send: &mut impl FnMut(&[u8])) {
        match self {
            Self::Xsens(device) => device.request(now, send),
            Self::VectorNav(device) => device.request(now, send),
            Self::Bridged(device) => device.request(now, send),
        }
    }

    fn complaint(&self) -> Option<InertialFault> {
        match self {
            Self::Xsens(device) => device.complaint(),
            Self::VectorNav(device) => device.complaint(),
            Self::Bridged(device) => device.complaint(),
        }
    }
}
