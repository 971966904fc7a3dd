//! The state of the motor, and its angle at the times of SYNC.

use floorguard_types::time::Stamp;

use super::configuration::ScanMotorConfiguration;
use crate::can::CanFrame;
use crate::canopen::{Emergency, NodeConfigurator, NodePhase, sync_frame};
use crate::cia402::{DriveGoal, PowerState, controlword};

/// From SYNC to SYNC: the angle is interpolated between, which no linear motion needs closer.
const SYNC_US: u64 = 10_000;
/// An angle that comes later than this after the newest SYNC is not that SYNC's.
const REPORT_US: u64 = 8_000;

/// Why the motor does not turn.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum ScanMotorFault {
    /// The drive is in its fault state; the code of its last emergency message, 0 without one.
    Drive(u16),
    /// It is not on the bus any more.
    Lost,
    /// It refuses its configuration; index and sub-index of the object.
    Refused(u16, u8),
}

/// What the motor reports.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum ScanMotorEvent {
    /// An angle.
    Angle {
        /// When it was measured: at the SYNC before.
        stamp: Stamp,
        /// Of the lidar, radians, left positive.
        angle_rad: f32,
        /// Speed that is commanded, radians a second; 0 while the drive is not enabled.
        commanded_radps: f32,
    },
    /// It reached a limit and turns back: a sweep has ended.
    SweepEnd,
    /// It does not turn. Given once until it turns again.
    Fault(ScanMotorFault),
}

/// Totals that saturate.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct ScanMotorCounters {
    /// Angles given.
    pub angles: u32,
    /// Reports too short, with an unknown state, or that belong to no SYNC.
    pub unusable: u32,
}

/// A motor between two limits.
#[derive(Clone, Debug)]
pub struct ScanMotor {
    configuration: ScanMotorConfiguration,
    node: NodeConfigurator,
    state: Option<PowerState>,
    emergency: u16,
    /// To the left; otherwise to the right.
    is_leftwards: bool,
    is_stopped: bool,
    fault: Option<ScanMotorFault>,
    sync: Option<Stamp>,
    is_reset_due: bool,
    counters: ScanMotorCounters,
}

impl ScanMotor {
    /// A motor of which nothing is known. It begins to turn once it is configured.
    #[must_use]
    pub fn new(configuration: ScanMotorConfiguration) -> Self {
        Self {
            configuration,
            node: NodeConfigurator::new(configuration.node, configuration.script()),
            state: None,
            emergency: 0,
            is_leftwards: true,
            is_stopped: false,
            fault: None,
            sync: None,
            is_reset_due: false,
            counters: ScanMotorCounters::default(),
        }
    }

    /// Stands still from now on, or turns again.
    pub fn stop(&mut self, is_stopped: bool) {
        self.is_stopped = is_stopped;
    }

    /// Leaves a fault of the drive with the next command.
    pub fn reset_fault(&mut self) {
        self.is_reset_due = true;
    }

    /// What happened so far.
    #[must_use]
    pub const fn counters(&self) -> ScanMotorCounters {
        self.counters
    }

    /// The drive follows its target.
    #[must_use]
    pub fn is_enabled(&self) -> bool {
        self.state == Some(PowerState::OperationEnabled)
    }

    /// A frame from the bus, at its arrival; others than those of this node are passed over.
    pub fn on_frame(&mut self, frame: &CanFrame, now: Stamp, event: &mut impl FnMut(ScanMotorEvent)) {
        let Some(id) = frame.standard_id() else { return };
        let node = u16::from(self.configuration.node);
        let payload = frame.payload();
        match id.checked_sub(node) {
            Some(0x180) => self.on_report(payload, now, event),
            Some(0x580) => {
                let _first = self.node.on_answer(payload, now);
            }
            Some(0x700) => {
                if let Some(state) = payload.first() {
                    let _found = self.node.on_heartbeat(*state, now);
                }
            }
            Some(0x080) => {
                if let Some(emergency) = Emergency::decode(payload) {
                    self.emergency = emergency.code;
                }
            }
            _ => {}
        }
    }

    fn on_report(&mut self, payload: &[u8], now: Stamp, event: &mut impl FnMut(ScanMotorEvent)) {
        let sync = self.sync.filter(|sync| *sync <= now && sync.past_us(now) <= REPORT_US);
        let (&[low, high, a, b, c, d, ..], Some(stamp)) = (payload, sync) else {
            self.counters.unusable = self.counters.unusable.saturating_add(1);
            return;
        };
        self.state = PowerState::from_statusword(u16::from_le_bytes([low, high]));
        let Some(state) = self.state else {
            self.counters.unusable = self.counters.unusable.saturating_add(1);
            return;
        };
        if state.is_fault() {
            self.report(ScanMotorFault::Drive(self.emergency), event);
        } else if state == PowerState::OperationEnabled {
            self.fault = None;
        }
        let angle_rad = self.configuration.angle_rad(i32::from_le_bytes([a, b, c, d]));
        let was_leftwards = self.is_leftwards;
        if angle_rad >= self.configuration.left_rad {
            self.is_leftwards = false;
        } else if angle_rad <= self.configuration.right_rad {
            self.is_leftwards = true;
        }
        self.counters.angles = self.counters.angles.saturating_add(1);
        event(ScanMotorEvent::Angle { stamp, angle_rad, commanded_radps: self.commanded_radps() });
        if was_leftwards != self.is_leftwards {
            event(ScanMotorEvent::SweepEnd);
        }
    }

    fn report(&mut self, fault: ScanMotorFault, event: &mut impl FnMut(ScanMotorEvent)) {
        if self.fault != Some(fault) {
            self.fault = Some(fault);
            event(ScanMotorEvent::Fault(fault));
        }
    }

    /// Speed of the lidar that is commanded, radians a second, left positive.
    #[must_use]
    pub fn commanded_radps(&self) -> f32 {
        let speed_radps = self.configuration.speed_radps;
        match (self.is_enabled() && !self.is_stopped, self.is_leftwards) {
            (false, _) => 0.0,
            (true, true) => speed_radps,
            (true, false) => -speed_radps,
        }
    }

    /// Time has passed: configures the node, and sends command and SYNC a hundred times a second.
    pub fn poll(
        &mut self,
        now: Stamp,
        event: &mut impl FnMut(ScanMotorEvent),
        send: &mut impl FnMut(&CanFrame),
    ) {
        if self.node.poll(now, send) {
            self.state = None;
            self.report(ScanMotorFault::Lost, event);
        }
        if self.node.phase() == NodePhase::Refused
            && let Some(failure) = self.node.failure()
        {
            self.report(ScanMotorFault::Refused(failure.index, failure.subindex), event);
        }
        let is_due = self.sync.is_none_or(|sync| sync.past_us(now) >= SYNC_US);
        if !(is_due && self.node.is_operational()) {
            return;
        }
        send(&self.command());
        send(&sync_frame());
        self.sync = Some(now);
    }

    /// Controlword and target velocity.
    fn command(&mut self) -> CanFrame {
        let word = match self.state {
            Some(PowerState::Fault) => {
                let reset = core::mem::take(&mut self.is_reset_due);
                if reset {
                    self.emergency = 0
                }
                controlword(PowerState::Fault, DriveGoal::ResetFault(reset))
            }
            Some(state) => controlword(state, DriveGoal::Operate),
            None => controlword(PowerState::NotReady, DriveGoal::Operate),
        };
        let target = self.configuration.motor_rpm(self.commanded_radps());
        let ([low, high], [a, b, c, d]) = (word.to_le_bytes(), target.to_le_bytes());
        let id = 0x200 | u16::from(self.configuration.node & 0x7F);
        CanFrame::standard(id, &[low, high, a, b, c, d])
    }
}
