//! Traction and steering: from a command to two process data objects, and back from two to one report.

use floorguard_types::number::{nearest_f32, saturating_i32};
use floorguard_types::sensing::{DriveFeedback, DriveState};
use floorguard_types::time::Stamp;

use crate::can::CanFrame;
use crate::cia402::{DriveGoal, PowerState, controlword, profile_error};

/// Code reported for a drive that left operation without a command and without an emergency message.
const LEFT_OPERATION: u16 = 0xFF01;
/// Code reported for a fault bit without an emergency message.
const UNNAMED_FAULT: u16 = 0x1000;
/// Thousandths of a degree per radian.
const MILLIDEGREES: f32 = 57_295.78;

/// How the robot is to stand still.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum StopKind {
    /// Category 2: ramp down, keep the torque.
    Hold,
    /// Category 1: quick stop, then no torque.
    Ramp,
    /// Category 0: no torque at once; the brake falls in.
    #[default]
    TorqueOff,
}

/// What the drives are to do.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum DriveCommand {
    /// Turn the front wheel's rim at this speed, m/s, and to this angle, radians, counter-clockwise.
    Move {
        /// Speed of the rim over ground.
        wheel_mps: f32,
        /// Steering angle.
        steering_rad: f32,
    },
    /// Stand still.
    Stop(StopKind),
}

impl Default for DriveCommand {
    fn default() -> Self {
        Self::Stop(StopKind::TorqueOff)
    }
}

impl DriveCommand {
    const fn goal(self) -> DriveGoal {
        match self {
            Self::Move { .. } | Self::Stop(StopKind::Hold) => DriveGoal::Operate,
            Self::Stop(StopKind::Ramp) => DriveGoal::QuickStop,
            Self::Stop(StopKind::TorqueOff) => DriveGoal::TorqueOff,
        }
    }
}

/// One drive as it reports itself.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Report {
    /// Of the last statusword; none before the first and after one without meaning.
    pub state: Option<PowerState>,
    /// What it measures, in its own unit.
    pub value: i32,
    /// It operated as commanded.
    pub operated: bool,
    /// Of the last emergency message; 0 when none is pending.
    pub emergency: u16,
    /// It left operation by itself, until the operator resets.
    pub left_operation: bool,
    /// Newer than what was last given on.
    pub fresh: bool,
}

impl Report {
    /// Statusword and value; `false`: too short, or without meaning.
    pub fn take(&mut self, payload: &[u8], goal: DriveGoal) -> bool {
        let &[low, high, a, b, c, d, ..] = payload else { return false };
        self.value = i32::from_le_bytes([a, b, c, d]);
        let was_fault = self.state.is_some_and(PowerState::is_fault);
        self.state = PowerState::from_statusword(u16::from_le_bytes([low, high]));
        let Some(state) = self.state else { return false };
        if was_fault && !state.is_fault() {
            // The next fault has its own code.
            self.emergency = 0;
        }
        self.left_operation |= profile_error(state, self.operated, goal);
        // Only a drive that operates as commanded can leave operation by itself.
        self.operated = state == PowerState::OperationEnabled && goal == DriveGoal::Operate;
        self.fresh = true;
        true
    }

    /// What it comes to for the guard.
    pub fn drive_state(&self) -> DriveState {
        match self.state {
            None | Some(PowerState::NotReady) => DriveState::Unknown,
            Some(state) if state.is_fault() => {
                DriveState::Fault(if self.emergency == 0 { UNNAMED_FAULT } else { self.emergency })
            }
            Some(_) if self.left_operation => DriveState::Fault(LEFT_OPERATION),
            Some(PowerState::OperationEnabled) => DriveState::Enabled,
            Some(PowerState::QuickStopActive) => DriveState::QuickStop,
            Some(_) => DriveState::Disabled,
        }
    }
}

/// Both drives.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Drives {
    traction: Report,
    steering: Report,
    command: DriveCommand,
    /// Steps left of a fault reset: zero, then the edge.
    reset_steps: u8,
}

/// Which drive.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Axis {
    Traction,
    Steering,
}

/// Polls of a fault reset: three without the bit, then three with it.
pub(crate) const RESET_STEPS: u8 = 6;

impl Drives {
    /// A process data object of a drive. The report is complete with the second one.
    pub fn on_report(&mut self, axis: Axis, payload: &[u8], now: Stamp) -> Result<Option<DriveFeedback>, ()> {
        let goal = self.command.goal();
        if !self.axis(axis).take(payload, goal) {
            return Err(());
        }
        if !(self.traction.fresh && self.steering.fresh) {
            return Ok(None);
        }
        self.traction.fresh = false;
        self.steering.fresh = false;
        Ok(Some(DriveFeedback {
            stamp: now,
            state: worse(self.traction.drive_state(), self.steering.drive_state()),
            wheel_speed_mps: nearest_f32(self.traction.value) * 1.0e-3,
            steering_rad: nearest_f32(self.steering.value) / MILLIDEGREES,
        }))
    }

    /// Speed that the traction drive last reported, m/s of the wheel's rim; none before it is heard.
    pub fn traction_mps(&self) -> Option<f32> {
        self.traction.state.map(|_| nearest_f32(self.traction.value) * 1.0e-3)
    }

    /// An emergency code of a drive; 0 when it has recovered.
    pub fn on_emergency(&mut self, axis: Axis, code: u16) {
        self.axis(axis).emergency = code;
    }

    /// A drive is gone: its last reports are void.
    pub fn forget(&mut self, axis: Axis) {
        *self.axis(axis) = Report::default();
    }

    pub fn command(&mut self, command: DriveCommand) {
        self.command = command;
    }

    pub const fn commanded(&self) -> DriveCommand {
        self.command
    }

    /// The operator asked to leave the fault state.
    pub fn reset_faults(&mut self) {
        self.reset_steps = RESET_STEPS;
        self.traction.left_operation = false;
        self.steering.left_operation = false;
        self.traction.operated = false;
        self.steering.operated = false;
    }

    /// One step of a fault reset has been sent.
    pub fn step(&mut self) {
        self.reset_steps = self.reset_steps.saturating_sub(1);
    }

    fn axis(&mut self, axis: Axis) -> &mut Report {
        match axis {
            Axis::Traction => &mut self.traction,
            Axis::Steering => &mut self.steering,
        }
    }

    /// What stops a drive in any state, also in one that is not known.
    fn stop_word(&self) -> u16 {
        match self.command.goal() {
            DriveGoal::TorqueOff | DriveGoal::ResetFault(_) => 0x0000,
            DriveGoal::QuickStop | DriveGoal::Operate => {
                controlword(PowerState::QuickStopActive, DriveGoal::QuickStop)
            }
        }
    }

    fn word(&self, report: &Report) -> u16 {
        let Some(state) = report.state else { return self.stop_word() };
        if state == PowerState::Fault && self.reset_steps > 0 {
            return controlword(state, DriveGoal::ResetFault(self.reset_steps <= RESET_STEPS / 2));
        }
        // What left operation by itself stays down until the operator resets.
        let goal = if report.left_operation { DriveGoal::TorqueOff } else { self.command.goal() };
        controlword(state, goal)
    }

    /// The frame to a traction drive that is not operational: no target, no way to operate.
    pub fn traction_stop_frame(&self, node: u8) -> CanFrame {
        process_data(node, self.stop_word(), 0)
    }

    /// The frame to a steering drive that is not operational. It loses its torque only where that is demanded: an
    /// angle that is held is no danger.
    pub fn steering_stop_frame(&self, node: u8) -> Option<CanFrame> {
        (self.command.goal() == DriveGoal::TorqueOff).then(|| process_data(node, 0x0000, self.steering.value))
    }

    /// The frame to the traction drive. The wheel turns only when both drives operate; a state that is not known is
    /// answered by a stop.
    pub fn traction_frame(&self, node: u8) -> CanFrame {
        let both = [self.traction.state, self.steering.state] == [Some(PowerState::OperationEnabled); 2];
        let target = match self.command {
            DriveCommand::Move { wheel_mps, .. } if both && wheel_mps.is_finite() => {
                saturating_i32(libm::roundf(wheel_mps * 1_000.0))
            }
            _ => 0,
        };
        process_data(node, self.word(&self.traction), target)
    }

    /// The frame to the steering drive. It stays where it is when the robot is to stand.
    pub fn steering_frame(&self, node: u8) -> Option<CanFrame> {
        let Some(state) = self.steering.state else { return self.steering_stop_frame(node) };
        let target = match self.command {
            DriveCommand::Move { steering_rad, .. } if steering_rad.is_finite() => {
                saturating_i32(libm::roundf(steering_rad * MILLIDEGREES))
            }
            _ => self.steering.value,
        };
        // Holding an angle is no danger, losing it at speed is: the steering gives up its torque last.
        let word = match (self.command, state) {
            (DriveCommand::Stop(StopKind::Ramp), PowerState::OperationEnabled)
                if !self.steering.left_operation =>
            {
                controlword(PowerState::OperationEnabled, DriveGoal::Operate)
            }
            _ => self.word(&self.steering),
        };
        Some(process_data(node, word, target))
    }
}

/// The first process data object to a drive: controlword and target.
pub(crate) fn process_data(node: u8, word: u16, target: i32) -> CanFrame {
    let ([low, high], [a, b, c, d]) = (word.to_le_bytes(), target.to_le_bytes());
    CanFrame::standard(0x200 | u16::from(node & 0x7F), &[low, high, a, b, c, d])
}

/// The worse of two states: a fault hides everything, then the unknown.
pub(crate) const fn worse(a: DriveState, b: DriveState) -> DriveState {
    match (a, b) {
        (DriveState::Fault(code), _) | (_, DriveState::Fault(code)) => DriveState::Fault(code),
        (DriveState::Unknown, _) | (_, DriveState::Unknown) => DriveState::Unknown,
        (DriveState::Disabled, _) | (_, DriveState::Disabled) => DriveState::Disabled,
        (DriveState::QuickStop, _) | (_, DriveState::QuickStop) => DriveState::QuickStop,
        (DriveState::Enabled, DriveState::Enabled) => DriveState::Enabled,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn report(drives: &mut Drives, axis: Axis, status: u16, value: i32) -> Option<DriveFeedback> {
        let ([low, high], [a, b, c, d]) = (status.to_le_bytes(), value.to_le_bytes());
        drives.on_report(axis, &[low, high, a, b, c, d], Stamp::ZERO).unwrap()
    }

    /// The frames of the book, CANopen: Process data, node 5.
    #[test]
    fn published_frames() {
        let mut drives = Drives::default();
        report(&mut drives, Axis::Steering, 0x0237, 0);
        let feedback = report(&mut drives, Axis::Traction, 0x0237, -1_234).unwrap();
        assert_eq!(feedback.state, DriveState::Enabled);
        assert!((feedback.wheel_speed_mps + 1.234).abs() < 1e-6);
        drives.command(DriveCommand::Move { wheel_mps: -1.0, steering_rad: 0.5 });
        assert_eq!(drives.traction_frame(5), CanFrame::standard(0x205, &[0x0F, 0, 0x18, 0xFC, 0xFF, 0xFF]));
    }

    #[test]
    fn no_wheel_turns_before_both_drives_operate() {
        let mut drives = Drives::default();
        assert_eq!(drives.traction_frame(1).payload(), [0; 6]);
        drives.command(DriveCommand::Move { wheel_mps: 1.0, steering_rad: 0.0 });
        report(&mut drives, Axis::Traction, 0x0237, 0);
        report(&mut drives, Axis::Steering, 0x0233, 0);
        assert_eq!(drives.traction_frame(1).payload(), [0x0F, 0, 0, 0, 0, 0]);
    }

    #[test]
    fn drive_leaving_operation_is_fault_until_reset() {
        let mut drives = Drives::default();
        drives.command(DriveCommand::Move { wheel_mps: 1.0, steering_rad: 0.0 });
        for status in [0x0237, 0x0250, 0x0250] {
            report(&mut drives, Axis::Traction, status, 0);
            let feedback = report(&mut drives, Axis::Steering, 0x0237, 0).unwrap();
            let wanted =
                if status == 0x0237 { DriveState::Enabled } else { DriveState::Fault(LEFT_OPERATION) };
            assert_eq!(feedback.state, wanted);
        }
        assert_eq!(drives.traction_frame(1).payload(), [0; 6]);
        drives.reset_faults();
        report(&mut drives, Axis::Traction, 0x0250, 0);
        assert_eq!(report(&mut drives, Axis::Steering, 0x0237, 0).unwrap().state, DriveState::Disabled);
    }

    /// A statusword that the profile does not know (ready, but with the quick-stop bit low) silences no stop.
    #[test]
    fn a_drive_in_an_unknown_state_is_stopped() {
        let go = DriveCommand::Move { wheel_mps: 1.0, steering_rad: 0.1 };
        let stop = DriveCommand::Stop;
        let stops = [
            (go, 0x02, None),
            (stop(StopKind::Hold), 0x02, None),
            (stop(StopKind::Ramp), 0x02, None),
            (stop(StopKind::TorqueOff), 0x00, Some(0x00)),
        ];
        for (command, word, steering_word) in stops {
            let mut drives = Drives::default();
            drives.command(go);
            report(&mut drives, Axis::Traction, 0x0237, 900);
            report(&mut drives, Axis::Steering, 0x0237, 0);
            assert_eq!(drives.traction_frame(1).payload(), [0x0F, 0, 0xE8, 3, 0, 0]);
            for axis in [Axis::Traction, Axis::Steering] {
                assert_eq!(drives.on_report(axis, &[0x01, 2, 0, 0, 0, 0], Stamp::ZERO), Err(()));
            }
            drives.command(command);
            let frame = drives.traction_frame(1);
            assert_eq!(frame.payload().first(), Some(&word), "{command:?}");
            assert_eq!(drives.traction_stop_frame(1).payload(), [word, 0, 0, 0, 0, 0]);
            let steering = drives.steering_frame(2);
            assert_eq!(steering, drives.steering_stop_frame(2));
            assert_eq!(steering.and_then(|frame| frame.payload().first().copied()), steering_word);
        }
    }

    /// The report that was in flight while a stop was taken back shows no drive that left operation by itself.
    #[test]
    fn withdrawn_stop_is_no_fault() {
        let mut drives = Drives::default();
        let go = DriveCommand::Move { wheel_mps: 1.0, steering_rad: 0.0 };
        drives.command(go);
        report(&mut drives, Axis::Traction, 0x0237, 0);
        drives.command(DriveCommand::Stop(StopKind::Ramp));
        report(&mut drives, Axis::Traction, 0x0237, 0);
        drives.command(go);
        report(&mut drives, Axis::Traction, 0x0217, 0);
        report(&mut drives, Axis::Steering, 0x0237, 0);
        assert_eq!(drives.traction_frame(1).payload(), [0; 6], "through switch-on disabled");
        assert!(!drives.traction.left_operation);
    }

    #[test]
    fn the_code_of_a_fault_ends_with_it() {
        let mut drives = Drives::default();
        drives.on_emergency(Axis::Traction, 0x5441);
        let mut state = |status| {
            report(&mut drives, Axis::Steering, 0x0240, 0);
            report(&mut drives, Axis::Traction, status, 0).unwrap().state
        };
        let seen = [0x0218, 0x0240, 0x0218].map(&mut state);
        assert_eq!(seen, [DriveState::Fault(0x5441), DriveState::Disabled, DriveState::Fault(UNNAMED_FAULT)]);
    }

    #[test]
    fn short_and_meaningless_reports_are_refused() {
        let mut drives = Drives::default();
        assert_eq!(drives.on_report(Axis::Traction, &[0x37, 2, 0, 0, 0], Stamp::ZERO), Err(()));
        assert_eq!(drives.on_report(Axis::Traction, &[0x2B, 0, 0, 0, 0, 0], Stamp::ZERO), Err(()));
    }
}
