//! What differs between the controllers: their frames.

use floorguard_types::time::Stamp;

use super::configuration::{MotorDrivesConfiguration, MotorProtocol};
use super::odrive_link::OdriveLink;
use super::roboteq_bus_link::RoboteqBusLink;
use super::roboteq_link::RoboteqLink;
use super::vesc_link::VescLink;
use super::wheel::Wheel;
use super::wheel_line_link::WheelLineLink;
use crate::can::CanFrame;
use crate::canopen::ConfigurationFailure;
use crate::wheel_drives::configuration::WHEELS_MAX;

/// What was heard.
pub(super) type Wheels = [Wheel; WHEELS_MAX];

/// What all wheels are to do.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Order {
    /// Torque is on.
    pub operate: bool,
    /// Speeds of the rims, forward, m/s.
    pub speeds_mps: [f32; WHEELS_MAX],
    /// Faults are to be left.
    pub reset: bool,
}

/// What came of a frame.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Taken {
    /// It was a controller's.
    Understood,
    /// It was, and had no meaning.
    Refused,
    /// It is another device's.
    Another,
}

/// The state of a conversation.
#[derive(Clone, Debug)]
pub(super) enum Link {
    Odrive(OdriveLink),
    Vesc(VescLink),
    Roboteq(RoboteqLink),
    RoboteqCan(RoboteqBusLink),
    WheelLine(WheelLineLink),
}

impl Link {
    pub fn new(bus: &MotorDrivesConfiguration) -> Self {
        match bus.protocol {
            MotorProtocol::Odrive => Self::Odrive(OdriveLink::default()),
            MotorProtocol::Vesc => Self::Vesc(VescLink),
            MotorProtocol::Roboteq => Self::Roboteq(RoboteqLink::default()),
            MotorProtocol::RoboteqCan => Self::RoboteqCan(RoboteqBusLink::new(bus)),
            MotorProtocol::WheelLine => Self::WheelLine(WheelLineLink::default()),
        }
    }

    pub fn take(
        &mut self,
        frame: &CanFrame,
        (now, bus): (Stamp, &MotorDrivesConfiguration),
        wheels: &mut Wheels,
    ) -> Taken {
        match self {
            Self::Odrive(_) => OdriveLink::take(frame, (now, bus), wheels),
            Self::Vesc(_) => VescLink::take(frame, (now, bus), wheels),
            Self::Roboteq(link) => link.take(frame, (now, bus), wheels),
            Self::RoboteqCan(link) => link.take(frame, (now, bus), wheels),
            Self::WheelLine(link) => link.take(frame, (now, bus), wheels),
        }
    }

    /// Ten milliseconds have passed; sends what a controller needs before it can be commanded.
    pub fn step(&mut self, now: Stamp, wheels: &mut Wheels, send: &mut impl FnMut(&CanFrame)) {
        match self {
            Self::Odrive(link) => link.step(),
            Self::RoboteqCan(link) => link.attend(now, wheels, send),
            Self::Vesc(_) => {}
            Self::Roboteq(link) => link.step(),
            Self::WheelLine(link) => link.renew(),
        }
    }

    /// Another command has come: what goes out next is newer than what went out.
    pub const fn renew(&mut self) {
        if let Self::WheelLine(link) = self {
            link.renew();
        }
    }

    /// A controller is gone.
    pub fn forget(&mut self) {
        match self {
            Self::WheelLine(link) => link.forget(),
            Self::Roboteq(link) => link.forget(),
            Self::RoboteqCan(link) => link.forget(),
            Self::Odrive(_) | Self::Vesc(_) => {}
        }
    }

    pub fn send(
        &self,
        order: &Order,
        (bus, wheels): (&MotorDrivesConfiguration, &Wheels),
        send: &mut impl FnMut(&CanFrame),
    ) {
        match self {
            Self::Odrive(link) => link.send(order, (bus, wheels), send),
            Self::Vesc(_) => VescLink::send(order, bus, send),
            Self::Roboteq(link) => link.send(order, (bus, wheels), send),
            Self::RoboteqCan(link) => link.send(order, (bus, wheels), send),
            Self::WheelLine(link) => link.send(order, bus, send),
        }
    }

    /// A wheel does not obey: what stops a controller without being obeyed, and else nothing, so that its watchdog stops it.
    pub fn send_emergency(&self, bus: &MotorDrivesConfiguration, send: &mut impl FnMut(&CanFrame)) {
        match self {
            Self::Odrive(_) => OdriveLink::send_emergency(bus, send),
            Self::Roboteq(_) => RoboteqLink::send_emergency(send),
            Self::RoboteqCan(link) => link.send_emergency(send),
            Self::Vesc(_) | Self::WheelLine(_) => {}
        }
    }

    /// Why a controller refuses to be configured.
    pub fn refusal(&self, node: u8) -> Option<ConfigurationFailure> {
        match self {
            Self::RoboteqCan(link) => link.refusal(node),
            _ => None,
        }
    }

    /// The controller's watchdog is shown by reading it back.
    pub fn watchdog_read(&self) -> Option<bool> {
        match self {
            Self::Roboteq(link) => Some(link.is_watchdog_set()),
            Self::RoboteqCan(link) => Some(link.is_watchdog_set()),
            _ => None,
        }
    }
}

/// Gives bytes of a line in frames of eight.
pub(super) fn send_bytes(bytes: &[u8], send: &mut impl FnMut(&CanFrame)) {
    for portion in bytes.chunks(8) {
        send(&CanFrame::standard(0, portion));
    }
}
