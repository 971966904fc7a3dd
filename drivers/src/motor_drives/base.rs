//! The master of the controllers: starts them, checks their watchdogs, leads the wheels, translates both ways.
//!
//! Sans-I/O: frames in with [`MotorDrives::on_frame`], frames out from [`MotorDrives::poll`] every 10 ms and, for a stop, from
//! [`MotorDrives::send_command`] at once.

use floorguard_types::number::truncating_u8;
use floorguard_types::sensing::WheelSample;
use floorguard_types::time::{Age, Stamp};

use super::configuration::{MotorDrivesConfiguration, MotorProtocol};
use super::judgement::STANDS_MPS;
use super::link::{Link, Order, Taken, Wheels};
use super::watchdog::WatchdogCheck;
use super::wheel::Condition;
use crate::can::CanFrame;
use crate::canopen::{ConfigurationFailure, Emergency, NodeConfigurator, master_heartbeat, sync_frame};
use crate::flexisoft::SafetyImage;
use crate::three_wheel_base::following_error::FollowingErrorMonitor;
use crate::three_wheel_base::{BaseConfiguration, BaseCounters, BaseEvent, StopKind};
use crate::wheel_drives::sides::SideMonitor;
use crate::wheel_drives::{SideTargets, WheelCommand};

/// Heartbeat of the master for the gateway, microseconds.
const HEARTBEAT_US: u64 = 50_000;
/// Seconds between two polls.
const POLL_S: f32 = 0.01;
/// Polls of a fault reset: as long as two heartbeats of an ODrive.
const RESET_POLLS: u8 = 22;
/// Code of a controller that left operation without a command.
const LEFT_OPERATION: u16 = 0xFF01;
/// Code of a controller whose watchdog stopped it while it was to drive: this computer was silent.
const WATCHDOG_ACTED: u16 = 0xFF06;

/// The controllers of two or four wheels, and the gateway of a safety controller, where there is one.
///
/// ```
/// use floorguard_drivers::motor_drives::{MotorDrives, MotorDrivesConfiguration};
/// use floorguard_types::time::Stamp;
///
/// let mut base = MotorDrives::new(MotorDrivesConfiguration::default());
/// let mut identifiers = Vec::new();
/// base.poll(Stamp::ZERO, &mut |_| {}, &mut |frame| identifiers.extend(frame.standard_id()));
/// // No axis was heard yet: both are commanded to be without torque (axes 1 and 2, message 07h).
/// assert_eq!((identifiers, base.is_complete()), (vec![0x027, 0x047], false));
/// ```
#[derive(Clone, Debug)]
pub struct MotorDrives {
    pub(super) configuration: MotorDrivesConfiguration,
    /// The same once more.
    copy: MotorDrivesConfiguration,
    link: Link,
    pub(super) wheels: Wheels,
    pub(super) command: WheelCommand,
    /// Where the ramp is.
    pub(super) targets: SideTargets,
    pub(super) watchdog: WatchdogCheck,
    pub(super) sides: SideMonitor,
    /// All operated as commanded.
    operated: bool,
    /// What took a controller out of operation, until the operator resets.
    pub(super) latched: Option<u16>,
    reset_polls: u8,
    inputs: Option<NodeConfigurator>,
    image: SafetyImage,
    heartbeat: Option<Stamp>,
    following_error: FollowingErrorMonitor,
    counters: BaseCounters,
}

impl MotorDrives {
    /// No controller was heard yet; they are to have no torque.
    #[must_use]
    pub fn new(configuration: MotorDrivesConfiguration) -> Self {
        let inputs = (configuration.inputs_node != 0)
            .then(|| NodeConfigurator::new(configuration.inputs_node, BaseConfiguration::inputs_script()));
        Self {
            link: Link::new(&configuration),
            wheels: Wheels::default(),
            command: WheelCommand::default(),
            targets: SideTargets::default(),
            watchdog: unchecked(configuration.protocol),
            sides: SideMonitor::default(),
            operated: false,
            latched: None,
            reset_polls: 0,
            inputs,
            image: SafetyImage::new(configuration.inputs),
            heartbeat: None,
            following_error: FollowingErrorMonitor::default(),
            counters: BaseCounters::default(),
            copy: configuration,
            configuration,
        }
    }

    /// A frame from the bus or the line. `event` is called at most once.
    pub fn on_frame(&mut self, frame: &CanFrame, now: Stamp, event: &mut impl FnMut(BaseEvent)) {
        self.counters.frames = self.counters.frames.saturating_add(1);
        let bus = self.configuration;
        match self.link.take(frame, (now, &bus), &mut self.wheels) {
            Taken::Understood => self.report(now, event),
            Taken::Refused => self.counters.refused = self.counters.refused.saturating_add(1),
            Taken::Another => self.on_inputs(frame, now, event),
        }
    }

    /// What all wheels have reported since the last report: counts, or else speeds; the other with the next frame.
    fn report(&mut self, now: Stamp, event: &mut impl FnMut(BaseEvent)) {
        let (bus, wheels) = (self.configuration, self.configuration.wheel_count());
        if self.wheels.iter().take(wheels).all(|wheel| wheel.has_new_count) {
            self.wheels.iter_mut().for_each(|wheel| wheel.has_new_count = false);
            let side = |first: usize| {
                let of_side = self.wheels.iter().enumerate().take(wheels).skip(first).step_by(2);
                let totals = of_side.map(|(index, wheel)| wheel.total_at(now, bus.counts_per_m(index)));
                totals.fold(0_i32, i32::wrapping_add)
            };
            event(BaseEvent::Wheels(WheelSample { stamp: now, left_ticks: side(0), right_ticks: side(1) }));
            return;
        }
        if self.wheels.iter().take(wheels).all(|wheel| wheel.has_new_speed) {
            self.wheels.iter_mut().for_each(|wheel| wheel.has_new_speed = false);
            let speeds_mps = self.wheels.map(|wheel| wheel.speed_mps);
            self.sides.watch(speeds_mps, wheels);
            let sides = SideTargets::measured(speeds_mps, wheels);
            event(BaseEvent::Drive(sides.feedback((now, self.state()), (bus.track_m, bus.lever_m))));
        }
    }

    /// The safety controller's gateway on the same bus.
    fn on_inputs(&mut self, frame: &CanFrame, now: Stamp, event: &mut impl FnMut(BaseEvent)) {
        let (Some(id), Some(device)) = (frame.standard_id(), &mut self.inputs) else { return };
        let (node, payload) = (truncating_u8(id & 0x7F), frame.payload());
        if node != device.node() {
            return;
        }
        match id & 0x780 {
            0x080 => {
                if let Some(emergency) = Emergency::decode(payload) {
                    event(BaseEvent::Emergency(node, emergency));
                }
            }
            0x180 | 0x280 | 0x380 | 0x480 => {
                let object = usize::from((id >> 8) & 7).saturating_sub(1);
                if let Some(inputs) = self.image.take(object, payload, now) {
                    event(BaseEvent::Inputs(inputs));
                }
            }
            0x580 => {
                let _ = device.on_answer(payload, now);
            }
            0x700 => {
                let _ = device.on_heartbeat(payload.first().copied().unwrap_or(u8::MAX), now);
            }
            _ => {}
        }
    }

    /// Ten milliseconds have passed: a step of the ramp and of the watchdogs' check, commands, and what the gateway needs.
    pub fn poll(&mut self, now: Stamp, event: &mut impl FnMut(BaseEvent), send: &mut impl FnMut(&CanFrame)) {
        self.lose_silent(now, event);
        self.link.step(now, &mut self.wheels, send);
        self.reset_polls = self.reset_polls.saturating_sub(1);
        self.ramp();
        self.check_watchdogs(now);
        self.latch();
        let ramp_mps2 = self.configuration.deceleration_mps2;
        let disobeys =
            self.following_error.watch(self.targets.fastest_mps(), self.fastest_mps(), ramp_mps2, now);
        if disobeys {
            self.counters.silences = self.counters.silences.saturating_add(1);
            self.link.send_emergency(&self.configuration, send);
        } else {
            self.send_command(send);
        }
        self.attend_inputs(now, event, send);
    }

    fn lose_silent(&mut self, now: Stamp, event: &mut impl FnMut(BaseEvent)) {
        let known = self.configuration.nodes.into_iter().zip(&mut self.wheels);
        let mut losses = 0_u32;
        for (node, wheel) in known.take(self.configuration.wheel_count()) {
            if wheel.is_lost(now) {
                wheel.forget();
                losses = losses.saturating_add(1);
                event(BaseEvent::NodeLost(node));
            }
        }
        if losses > 0 {
            self.counters.losses = self.counters.losses.saturating_add(losses);
            // One that comes back may have other settings.
            self.watchdog = unchecked(self.configuration.protocol);
            self.link.forget();
        }
    }

    fn attend_inputs(
        &mut self,
        now: Stamp,
        event: &mut impl FnMut(BaseEvent),
        send: &mut impl FnMut(&CanFrame),
    ) {
        let Some(inputs) = &mut self.inputs else { return };
        send(&sync_frame());
        if self.heartbeat.is_none_or(|sent| !matches!(sent.age(now), Age::Past(us) if us < HEARTBEAT_US)) {
            self.heartbeat = Some(now);
            send(&master_heartbeat(self.configuration.master_node));
        }
        if inputs.poll(now, send) {
            self.counters.losses = self.counters.losses.saturating_add(1);
            event(BaseEvent::NodeLost(inputs.node()));
        }
    }

    fn ramp(&mut self) {
        let bus = self.configuration;
        let is_torque_off = bus.has_brakes && self.command == WheelCommand::Stop(StopKind::TorqueOff);
        if !self.operates() || is_torque_off {
            self.targets = SideTargets::default();
            return;
        }
        let wanted = match self.command {
            WheelCommand::Move(wanted) if wanted.is_finite() => wanted,
            _ => SideTargets::default(),
        };
        let faster = wanted.fastest_mps() > self.targets.fastest_mps();
        let ramp_mps2 = if faster { bus.acceleration_mps2 } else { bus.deceleration_mps2 };
        self.targets = self.targets.toward(wanted, ramp_mps2.max(0.0) * POLL_S);
    }

    fn check_watchdogs(&mut self, now: Stamp) {
        if self.watchdog == WatchdogCheck::Unknowable {
            return;
        }
        if let Some(is_set) = self.link.watchdog_read() {
            self.watchdog = if is_set { WatchdogCheck::Passed } else { WatchdogCheck::Pending };
            if !is_set {
                // What is not shown any more drives no further: the controller leads the wheels down by its own ramp.
                self.targets = SideTargets::default();
            }
            return;
        }
        let stands = self.fastest_mps().is_some_and(|mps| mps < STANDS_MPS);
        let is_ready = self.all(Condition::On) && stands;
        let asked = (self.is_to_operate(), is_ready, self.all(Condition::Expired));
        self.watchdog = self.watchdog.step(asked, (now, self.configuration.watchdog_ms));
    }

    /// What leaves operation by itself stays down until the operator resets.
    fn latch(&mut self) {
        if self.operated && self.is_to_operate() && !self.all(Condition::On) {
            let why = self.wheels.iter().take(self.configuration.wheel_count()).find_map(|wheel| match wheel
                .condition
            {
                Condition::On | Condition::Unknown => None,
                Condition::Off => Some(LEFT_OPERATION),
                Condition::Expired => Some(WATCHDOG_ACTED),
                Condition::Fault(code) => Some(code),
            });
            self.latched = self.latched.or(why);
        }
        self.operated = self.operates() && self.is_to_operate();
    }

    /// What the wheels are to do from now on; goes out with the next poll or [`Self::send_command`]. The first step of a stop is taken
    /// here, so that what is sent at once is slower already.
    pub fn command(&mut self, command: WheelCommand) {
        let was_moving = matches!(self.command, WheelCommand::Move(_));
        self.command = command;
        self.link.renew();
        if was_moving && matches!(command, WheelCommand::Stop(_)) {
            self.ramp();
        }
    }

    /// The last command to the wheels.
    #[must_use]
    pub const fn commanded(&self) -> WheelCommand {
        self.command
    }

    /// Sends the command at once: a stop does not wait for the next poll. Nothing goes out while the watchdogs are checked, unless it is
    /// a stop.
    pub fn send_command(&self, send: &mut impl FnMut(&CanFrame)) {
        let operate = self.is_to_operate();
        if operate && matches!(self.watchdog, WatchdogCheck::Silent(_)) {
            return;
        }
        let SideTargets { left_mps, right_mps } = self.targets;
        let order = Order {
            operate: operate && self.watchdog != WatchdogCheck::Failed,
            speeds_mps: [left_mps, right_mps, left_mps, right_mps],
            reset: self.reset_polls > 0,
        };
        self.link.send(&order, (&self.configuration, &self.wheels), send);
    }

    /// The operator asked for a reset: controllers that wait for one leave their faults.
    pub fn reset_faults(&mut self) {
        (self.latched, self.operated, self.reset_polls) = (None, false, RESET_POLLS);
        self.sides = SideMonitor::default();
        if self.watchdog == WatchdogCheck::Failed {
            self.watchdog = WatchdogCheck::Pending;
        }
    }

    /// What it was configured with is what it was at the start; `false` after a flipped bit (FG-REQ-058).
    #[must_use]
    pub fn is_whole(&self) -> bool {
        self.configuration == self.copy
    }

    /// All controllers are heard, and the gateway operates.
    #[must_use]
    pub fn is_complete(&self) -> bool {
        let known = self.wheels.iter().take(self.configuration.wheel_count());
        known.map(|wheel| wheel.condition).all(|condition| condition != Condition::Unknown)
            && self.inputs.as_ref().is_none_or(NodeConfigurator::is_operational)
    }

    /// Which controllers are heard, with their numbers, in the order of the wheels.
    pub fn heard(&self) -> impl Iterator<Item = (u8, bool)> {
        let known = self.configuration.nodes.into_iter().zip(&self.wheels);
        known.take(self.configuration.wheel_count()).map(|(node, wheel)| (node, wheel.heard.is_some()))
    }

    /// Why a controller refuses to be configured; none where it does not, or where there is nothing to configure.
    #[must_use]
    pub fn refusal(&self, node: u8) -> Option<ConfigurationFailure> {
        self.link.refusal(node)
    }

    /// The gateway of the safety controller.
    #[must_use]
    pub const fn gateway(&self) -> Option<&NodeConfigurator> {
        self.inputs.as_ref()
    }

    /// What is known of the controllers' own watchdogs.
    #[must_use]
    pub const fn watchdog(&self) -> WatchdogCheck {
        self.watchdog
    }

    /// What was ignored.
    #[must_use]
    pub const fn counters(&self) -> BaseCounters {
        self.counters
    }
}

/// Before anything is known of a watchdog.
const fn unchecked(protocol: MotorProtocol) -> WatchdogCheck {
    match protocol {
        MotorProtocol::Vesc => WatchdogCheck::Unknowable,
        MotorProtocol::Odrive
        | MotorProtocol::Roboteq
        | MotorProtocol::RoboteqCan
        | MotorProtocol::WheelLine => WatchdogCheck::Pending,
    }
}
