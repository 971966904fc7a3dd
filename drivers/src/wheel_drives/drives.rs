//! The drives of all wheels as one: targets that keep the curve, and one report.
//!
//! A drive that brakes by a ramp of its own would bend the curve: the inner wheel stands while the outer one still turns. So
//! the master leads all wheels to their speeds together, one step each poll, and they reach standstill at the same moment. The
//! drives' own ramps and quick stop are for a bus that is silent (FG-REQ-080).

use floorguard_types::number::{nearest_f32, saturating_i32};
use floorguard_types::sensing::{DriveFeedback, DriveState};
use floorguard_types::time::Stamp;

use super::configuration::{WHEELS_MAX, WheelDrivesConfiguration};
use super::sides::{SideMonitor, SideTargets};
use crate::can::CanFrame;
use crate::cia402::{DriveGoal, PowerState, controlword};
use crate::three_wheel_base::StopKind;
use crate::three_wheel_base::drives::{RESET_STEPS, Report, process_data, worse};

/// A wheel that turns slower stands, m/s.
const STANDS_MPS: f32 = 0.02;
/// Seconds between two polls.
const POLL_S: f32 = 0.01;

/// What the wheels are to do.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum WheelCommand {
    /// Turn at these speeds.
    Move(SideTargets),
    /// Stand still.
    Stop(StopKind),
}

impl Default for WheelCommand {
    fn default() -> Self {
        Self::Stop(StopKind::TorqueOff)
    }
}

/// All drives.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct WheelGroup {
    reports: [Report; WHEELS_MAX],
    wheels: usize,
    command: WheelCommand,
    /// Where the ramp is.
    targets: SideTargets,
    /// Steps left of a fault reset: zero, then the edge.
    reset_steps: u8,
    sides: SideMonitor,
}

impl WheelGroup {
    pub fn new(wheels: usize) -> Self {
        Self { wheels: wheels.min(WHEELS_MAX), ..Self::default() }
    }

    fn reports(&self) -> impl Iterator<Item = &Report> {
        self.reports.iter().take(self.wheels)
    }

    /// Status and speed of a wheel. The report is complete when every wheel has sent one.
    pub fn on_report(
        &mut self,
        wheel: usize,
        payload: &[u8],
        (now, bus): (Stamp, &WheelDrivesConfiguration),
    ) -> Result<Option<DriveFeedback>, ()> {
        let goal = self.goal();
        let taken = self.reports.get_mut(wheel).is_some_and(|report| report.take(payload, goal));
        if !taken {
            return Err(());
        }
        if !self.reports().all(|report| report.fresh) {
            return Ok(None);
        }
        self.reports.iter_mut().for_each(|report| report.fresh = false);
        let speeds_mps = [0, 1, 2, 3].map(|wheel| self.wheel_mps(wheel));
        self.sides.watch(speeds_mps, self.wheels);
        let sides = SideTargets::measured(speeds_mps, self.wheels);
        Ok(Some(sides.feedback((now, self.state()), (bus.track_m, bus.lever_m))))
    }

    /// The worst of all drives.
    fn state(&self) -> DriveState {
        if let Some(code) = self.sides.fault() {
            return DriveState::Fault(code);
        }
        self.reports().fold(DriveState::Enabled, |state, report| worse(state, report.drive_state()))
    }

    fn wheel_mps(&self, wheel: usize) -> f32 {
        self.reports.get(wheel).map_or(0.0, |report| nearest_f32(report.value) * 1.0e-3)
    }

    /// Speed of the fastest wheel as last reported, m/s; none before all are heard.
    pub fn fastest_mps(&self) -> Option<f32> {
        let heard = self.reports().all(|report| report.state.is_some());
        let fastest = |most: f32, wheel| most.max(libm::fabsf(self.wheel_mps(wheel)));
        heard.then(|| (0..self.wheels.min(WHEELS_MAX)).fold(0.0, fastest))
    }

    /// Speed of the fastest target, m/s.
    pub fn target_mps(&self) -> f32 {
        self.targets.fastest_mps()
    }

    /// An emergency code of a drive; 0 when it has recovered.
    pub fn on_emergency(&mut self, wheel: usize, code: u16) {
        if let Some(report) = self.reports.get_mut(wheel) {
            report.emergency = code;
        }
    }

    /// A drive is gone: its last reports are void.
    pub fn forget(&mut self, wheel: usize) {
        if let Some(report) = self.reports.get_mut(wheel) {
            *report = Report::default();
        }
    }

    pub fn command(&mut self, command: WheelCommand) {
        self.command = command;
        if !matches!(command, WheelCommand::Move(_)) && self.goal() != DriveGoal::Operate {
            self.targets = SideTargets::default();
        }
    }

    pub const fn commanded(&self) -> WheelCommand {
        self.command
    }

    /// The operator asked to leave the fault state.
    pub fn reset_faults(&mut self) {
        self.reset_steps = RESET_STEPS;
        self.sides = SideMonitor::default();
        for report in &mut self.reports {
            (report.left_operation, report.operated) = (false, false);
        }
    }

    /// Ten milliseconds have passed: one step of the ramp, and of a fault reset.
    pub fn step(&mut self, bus: &WheelDrivesConfiguration) {
        self.reset_steps = self.reset_steps.saturating_sub(1);
        self.ramp(bus);
    }

    /// One step of the ramp.
    pub fn ramp(&mut self, bus: &WheelDrivesConfiguration) {
        let operates = self.reports().all(|report| report.state == Some(PowerState::OperationEnabled));
        let wanted = match self.command {
            WheelCommand::Move(wanted) if operates && wanted.is_finite() => wanted,
            _ => SideTargets::default(),
        };
        if !operates || self.command == WheelCommand::Stop(StopKind::TorqueOff) {
            self.targets = SideTargets::default();
            return;
        }
        let faster = wanted.fastest_mps() > self.targets.fastest_mps();
        let ramp_mps2 = if faster { bus.acceleration_mps2 } else { bus.deceleration_mps2 };
        self.targets = self.targets.toward(wanted, ramp_mps2.max(0.0) * POLL_S);
    }

    /// A quick stop begins where the common ramp has ended.
    fn goal(&self) -> DriveGoal {
        match self.command {
            WheelCommand::Move(_) | WheelCommand::Stop(StopKind::Hold) => DriveGoal::Operate,
            WheelCommand::Stop(StopKind::TorqueOff) => DriveGoal::TorqueOff,
            WheelCommand::Stop(StopKind::Ramp) => {
                let stands = self.fastest_mps().is_none_or(|mps| mps < STANDS_MPS);
                let is_ramp_over = self.targets == SideTargets::default();
                let operates =
                    self.reports().all(|report| report.state == Some(PowerState::OperationEnabled));
                if operates && !(is_ramp_over && stands) { DriveGoal::Operate } else { DriveGoal::QuickStop }
            }
        }
    }

    /// What stops a drive in any state, also in one that is not known.
    fn stop_word(&self) -> u16 {
        match self.command {
            WheelCommand::Stop(StopKind::TorqueOff) => 0x0000,
            _ => controlword(PowerState::QuickStopActive, DriveGoal::QuickStop),
        }
    }

    /// The frame to a drive that is not operational: no target, no way to operate.
    pub fn stop_frame(&self, node: u8) -> CanFrame {
        process_data(node, self.stop_word(), 0)
    }

    /// The frame to a wheel's drive. Wheels turn only when all drives operate; a state that is not known is answered by a stop.
    pub fn frame(&self, wheel: usize, node: u8) -> CanFrame {
        let Some((report, state)) = self.reports.get(wheel).and_then(|report| Some((report, report.state?)))
        else {
            return self.stop_frame(node);
        };
        if state == PowerState::Fault && self.reset_steps > 0 {
            let edge = DriveGoal::ResetFault(self.reset_steps <= RESET_STEPS / 2);
            return process_data(node, controlword(state, edge), 0);
        }
        // What left operation by itself stays down until the operator resets.
        let goal = if report.left_operation { DriveGoal::TorqueOff } else { self.goal() };
        let side_mps = if wheel & 1 == 0 { self.targets.left_mps } else { self.targets.right_mps };
        process_data(node, controlword(state, goal), saturating_i32(libm::roundf(side_mps * 1_000.0)))
    }
}
