//! What the controllers together are: all follow, torque is wanted, the worst of their states.

use floorguard_types::sensing::DriveState;

use super::base::MotorDrives;
use super::watchdog::WatchdogCheck;
use super::wheel::{Condition, Wheel};
use crate::three_wheel_base::StopKind;
use crate::three_wheel_base::drives::worse;
use crate::wheel_drives::{SideTargets, WheelCommand};

/// A wheel that turns slower stands, m/s.
pub(super) const STANDS_MPS: f32 = 0.02;
/// Code of a controller whose watchdog does not stop it.
const NO_WATCHDOG: u16 = 0xFF05;

impl MotorDrives {
    /// The wheels that there are.
    pub(super) fn known(&self) -> impl Iterator<Item = &Wheel> {
        self.wheels.iter().take(self.configuration.wheel_count())
    }

    pub(super) fn all(&self, condition: Condition) -> bool {
        self.known().all(|wheel| wheel.condition == condition)
    }

    /// Every controller follows, and may.
    pub(super) fn operates(&self) -> bool {
        self.all(Condition::On) && self.watchdog.allows() && self.latched.is_none()
    }

    /// Torque is wanted: to drive, to hold, or to be led to standstill before it goes.
    pub(super) fn is_to_operate(&self) -> bool {
        let is_led = match self.command {
            WheelCommand::Move(_) | WheelCommand::Stop(StopKind::Hold) => return self.latched.is_none(),
            WheelCommand::Stop(StopKind::Ramp) => true,
            WheelCommand::Stop(StopKind::TorqueOff) => !self.configuration.has_brakes,
        };
        let stands = self.fastest_mps().is_none_or(|mps| mps < STANDS_MPS);
        let is_over = stands && self.targets == SideTargets::default();
        let is_on = |wheel: &Wheel| wheel.condition == Condition::On;
        is_led && !is_over && self.known().any(is_on)
    }

    /// The worst of all controllers.
    pub(super) fn state(&self) -> DriveState {
        if let Some(code) = self.latched.or_else(|| self.sides.fault()) {
            return DriveState::Fault(code);
        }
        if self.watchdog == WatchdogCheck::Failed {
            return DriveState::Fault(NO_WATCHDOG);
        }
        let may_drive = if self.watchdog.allows() { DriveState::Enabled } else { DriveState::Disabled };
        self.known().fold(may_drive, |state, wheel| {
            let of_wheel = match wheel.condition {
                Condition::Unknown => DriveState::Unknown,
                Condition::Off | Condition::Expired => DriveState::Disabled,
                Condition::On => DriveState::Enabled,
                Condition::Fault(code) => DriveState::Fault(code),
            };
            worse(state, of_wheel)
        })
    }

    /// Speed of the fastest wheel as last reported, m/s; none before all are heard.
    pub(super) fn fastest_mps(&self) -> Option<f32> {
        let are_heard = self.known().all(|wheel| wheel.condition != Condition::Unknown);
        are_heard.then(|| self.known().fold(0.0_f32, |most, wheel| most.max(libm::fabsf(wheel.speed_mps))))
    }
}
