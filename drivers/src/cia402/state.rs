//! From statusword to state, and from state and goal to the next controlword.

/// State of the power drive system.
///
/// ```
/// use floorguard_drivers::cia402::PowerState;
///
/// assert_eq!(PowerState::from_statusword(0x0237), Some(PowerState::OperationEnabled));
/// assert_eq!(PowerState::from_statusword(0x0250), Some(PowerState::SwitchOnDisabled));
/// assert!(PowerState::from_statusword(0x0218).unwrap().is_fault());
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PowerState {
    /// Self-test.
    NotReady,
    /// Waits for "shutdown".
    SwitchOnDisabled,
    /// Waits for "switch on".
    Ready,
    /// Power on, no torque.
    SwitchedOn,
    /// Follows its target.
    OperationEnabled,
    /// Ramping down, or held after it.
    QuickStopActive,
    /// Ramping down because of a fault.
    FaultReaction,
    /// Torque off until a fault reset.
    Fault,
}

impl PowerState {
    /// Decodes a statusword; `None` for a pattern that the profile does not know.
    #[must_use]
    pub const fn from_statusword(status: u16) -> Option<Self> {
        match (status & 0x4F, status & 0x6F) {
            (0x00, _) => Some(Self::NotReady),
            (0x40, _) => Some(Self::SwitchOnDisabled),
            (0x0F, _) => Some(Self::FaultReaction),
            (0x08, _) => Some(Self::Fault),
            (_, 0x21) => Some(Self::Ready),
            (_, 0x23) => Some(Self::SwitchedOn),
            (_, 0x27) => Some(Self::OperationEnabled),
            (_, 0x07) => Some(Self::QuickStopActive),
            _ => None,
        }
    }

    /// The drive is in trouble.
    #[must_use]
    pub const fn is_fault(self) -> bool {
        matches!(self, Self::Fault | Self::FaultReaction)
    }
}

/// What the master wants of the drive.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum DriveGoal {
    /// No torque: category 0, or the end of category 1.
    #[default]
    TorqueOff,
    /// Ramp down as fast as configured, then no torque: category 1.
    QuickStop,
    /// Torque on, follow the target (which may be zero: category 2).
    Operate,
    /// Leave the fault state; `true` for the rising edge.
    ResetFault(bool),
}

/// The controlword that leads one step from a state towards a goal. "Enable operation" is sent only to a drive that has
/// reported "switched on" or later.
///
/// ```
/// use floorguard_drivers::cia402::{DriveGoal, PowerState, controlword};
///
/// // One step at a time, each after the statusword that the one before leads to.
/// let step = |status| controlword(PowerState::from_statusword(status).unwrap(), DriveGoal::Operate);
/// assert_eq!([0x0250, 0x0231, 0x0233].map(step), [0x0006, 0x0007, 0x000F]);
/// assert_eq!(controlword(PowerState::OperationEnabled, DriveGoal::QuickStop), 0x0002);
/// ```
#[must_use]
pub const fn controlword(state: PowerState, goal: DriveGoal) -> u16 {
    match goal {
        DriveGoal::TorqueOff => 0x0000,
        DriveGoal::ResetFault(true) => 0x0080,
        DriveGoal::ResetFault(false) => 0x0000,
        DriveGoal::QuickStop => match state {
            PowerState::OperationEnabled | PowerState::QuickStopActive => 0x0002,
            _ => 0x0000,
        },
        DriveGoal::Operate => match state {
            PowerState::SwitchOnDisabled => 0x0006,
            PowerState::Ready => 0x0007,
            PowerState::SwitchedOn | PowerState::OperationEnabled => 0x000F,
            // Out of a quick stop through "switch-on disabled": not every drive knows the short way.
            PowerState::QuickStopActive
            | PowerState::NotReady
            | PowerState::FaultReaction
            | PowerState::Fault => 0x0000,
        },
    }
}

/// The fault of a drive that left operation without a command.
#[must_use]
pub const fn profile_error(state: PowerState, operated: bool, goal: DriveGoal) -> bool {
    operated
        && matches!(goal, DriveGoal::Operate)
        && !matches!(state, PowerState::OperationEnabled | PowerState::Fault | PowerState::FaultReaction)
}

#[cfg(test)]
mod tests {
    use super::PowerState::*;
    use super::*;

    /// The examples of the book, CANopen: CiA 402 drives, checked against an independent implementation.
    #[test]
    fn published_statuswords() {
        let table: [(PowerState, &[u16]); 8] = [
            (NotReady, &[0x0000]),
            (SwitchOnDisabled, &[0x0040, 0x0240, 0x0250, 0x0270, 0x1250]),
            (Ready, &[0x0221, 0x0231]),
            (SwitchedOn, &[0x0233]),
            (OperationEnabled, &[0x0237, 0x0637, 0x1637, 0x8237]),
            (QuickStopActive, &[0x0207, 0x0217]),
            (FaultReaction, &[0x021F]),
            (Fault, &[0x0208, 0x0218]),
        ];
        for (state, words) in table {
            for word in words {
                assert_eq!(PowerState::from_statusword(*word), Some(state), "{word:04X}");
            }
        }
        // Of a public capture of a two-wheel base (fault, remote).
        assert_eq!(PowerState::from_statusword(0x4238), Some(Fault));
    }

    #[test]
    fn climbs_one_step_at_a_time() {
        let climb = [SwitchOnDisabled, Ready, SwitchedOn, OperationEnabled];
        assert_eq!(climb.map(|state| controlword(state, DriveGoal::Operate)), [0x06, 0x07, 0x0F, 0x0F]);
        for state in [NotReady, SwitchOnDisabled, Ready, QuickStopActive, FaultReaction, Fault] {
            assert_ne!(controlword(state, DriveGoal::Operate), 0x0F, "{state:?}");
        }
    }

    #[test]
    fn stops_never_carry_the_enable_bit() {
        for status in 0..=u16::MAX {
            let Some(state) = PowerState::from_statusword(status) else { continue };
            for goal in [DriveGoal::TorqueOff, DriveGoal::QuickStop, DriveGoal::ResetFault(true)] {
                assert_eq!(controlword(state, goal) & 0x0008, 0);
            }
            assert_eq!(controlword(state, DriveGoal::TorqueOff) & 0x0002, 0, "voltage off");
            assert_eq!(controlword(state, DriveGoal::QuickStop) & 0x0004, 0, "quick stop is active low");
        }
    }
}
