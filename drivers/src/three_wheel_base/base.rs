//! The master of the bus: boots the devices, keeps them alive, translates both ways.
//!
//! Sans-I/O: frames in with [`ThreeWheelBase::on_frame`], frames out from [`ThreeWheelBase::poll`] every 10 ms and, for
//! a stop, from [`ThreeWheelBase::send_command`] at once.

use floorguard_types::number::truncating_u8;
use floorguard_types::sensing::{DirtReading, DiscreteInputs, DriveFeedback, WheelSample};
use floorguard_types::time::{Age, Stamp};

use super::configuration::BaseConfiguration;
use super::drives::{Axis, DriveCommand, Drives};
use super::encoders::{EncoderReading, Encoders, Side};
use super::following_error::FollowingErrorMonitor;
use crate::can::CanFrame;
use crate::canopen::{
    Emergency, NetworkCommand, NodeConfigurator, master_heartbeat, network_frame, sync_frame,
};
use crate::cia406::EncoderReport;
use crate::flexisoft::SafetyImage;

/// Heartbeat of the master, microseconds: a quarter of what the drives tolerate.
const HEARTBEAT_US: u64 = 50_000;
/// An answer to a SYNC that is later than this belongs to nothing, microseconds.
const LATE_US: u64 = 9_000;

/// What the bus reported.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum BaseEvent {
    /// Both wheels, latched at the same moment.
    Wheels(WheelSample),
    /// Both drives.
    Drive(DriveFeedback),
    /// Emergency stop, bumpers, cliff sensors.
    Inputs(DiscreteInputs),
    /// The dirt sensor.
    Dirt(DirtReading),
    /// A device complained; its number.
    Emergency(u8, Emergency),
    /// A device fell silent; its number.
    NodeLost(u8),
    /// The traction drive was set up, and perhaps in operation, before this master started it: the master was away, the drive
    /// was not.
    FoundRunning,
}

/// What was ignored; saturating.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct BaseCounters {
    /// Frames taken in.
    pub frames: u32,
    /// Process data shorter than their mapping, or without meaning.
    pub refused: u32,
    /// Positions that came too late for their SYNC.
    pub late: u32,
    /// Devices lost.
    pub losses: u32,
    /// Polls during which the traction drive, which did not obey, was left without heartbeat.
    pub silences: u32,
}

/// The five devices.
///
/// ```
/// use floorguard_drivers::three_wheel_base::{BaseConfiguration, DriveCommand, StopKind, ThreeWheelBase};
/// use floorguard_types::time::Stamp;
///
/// let mut base = ThreeWheelBase::new(BaseConfiguration::default());
/// assert_eq!(base.commanded(), DriveCommand::Stop(StopKind::TorqueOff));
/// // No device answers yet: the five devices are called, and the base is not complete.
/// let mut identifiers = Vec::new();
/// base.poll(Stamp::ZERO, &mut |_| {}, &mut |frame| identifiers.extend(frame.standard_id()));
/// assert!(identifiers.contains(&0x77F), "the master's own heartbeat");
/// assert!(!base.is_complete());
/// ```
#[derive(Clone, Debug)]
pub struct ThreeWheelBase {
    pub(super) configuration: BaseConfiguration,
    /// The same once more.
    copy: BaseConfiguration,
    traction: NodeConfigurator,
    steering: NodeConfigurator,
    left: NodeConfigurator,
    right: NodeConfigurator,
    inputs: NodeConfigurator,
    drives: Drives,
    encoders: Encoders,
    pub(super) image: SafetyImage,
    latched: Stamp,
    heartbeat: Option<Stamp>,
    following_error: FollowingErrorMonitor,
    counters: BaseCounters,
}

impl ThreeWheelBase {
    /// Nobody was heard yet; the drives are to have no torque.
    #[must_use]
    pub fn new(configuration: BaseConfiguration) -> Self {
        let encoder = |node| NodeConfigurator::new(node, BaseConfiguration::encoder_script(node));
        Self {
            traction: NodeConfigurator::new(configuration.traction_node, configuration.traction_script()),
            steering: NodeConfigurator::new(configuration.steering_node, configuration.steering_script()),
            left: encoder(configuration.left_encoder_node),
            right: encoder(configuration.right_encoder_node),
            inputs: NodeConfigurator::new(configuration.inputs_node, BaseConfiguration::inputs_script()),
            drives: Drives::default(),
            encoders: Encoders::default(),
            image: SafetyImage::new(configuration.inputs),
            latched: Stamp::ZERO,
            heartbeat: None,
            following_error: FollowingErrorMonitor::default(),
            counters: BaseCounters::default(),
            copy: configuration,
            configuration,
        }
    }

    /// A frame from the bus. `event` is called at most once.
    pub fn on_frame(&mut self, frame: &CanFrame, now: Stamp, event: &mut impl FnMut(BaseEvent)) {
        let Some(id) = frame.standard_id() else { return };
        self.counters.frames = self.counters.frames.saturating_add(1);
        let node = truncating_u8(id & 0x7F);
        let payload = frame.payload();
        match id & 0x780 {
            0x080 => self.on_emergency(node, payload, event),
            0x180 => self.on_process_data(node, payload, now, event),
            0x280 => self.on_image(node, (1, payload), now, event),
            0x380 => self.on_image(node, (2, payload), now, event),
            0x480 => self.on_image(node, (3, payload), now, event),
            0x580 => {
                let is_found = self.device(node).is_some_and(|device| device.on_answer(payload, now));
                if is_found {
                    self.on_found(node, event);
                }
            }
            0x700 => {
                let byte = payload.first().copied().unwrap_or(u8::MAX);
                let is_found = self.device(node).is_some_and(|device| device.on_heartbeat(byte, now));
                if is_found {
                    self.on_found(node, event);
                }
            }
            _ => {}
        }
    }

    /// Ten milliseconds have passed: SYNC, commands, heartbeat, and whatever the devices' start needs.
    pub fn poll(&mut self, now: Stamp, event: &mut impl FnMut(BaseEvent), send: &mut impl FnMut(&CanFrame)) {
        // The command first: a serial line sends in order, and nothing may hold a stop up.
        self.send_command(send);
        let silent = self.has_following_error(now);
        let start = network_frame(NetworkCommand::Start, self.configuration.traction_node);
        if silent {
            self.counters.silences = self.counters.silences.saturating_add(1);
            // It may obey the next frame that reaches it; what counts is its own watch over the heartbeat.
            send(&network_frame(NetworkCommand::Stop, self.configuration.traction_node));
        }
        self.drives.step();
        self.encoders.begin();
        self.latched = now;
        send(&sync_frame());
        let due =
            self.heartbeat.is_none_or(|sent| !matches!(sent.age(now), Age::Past(us) if us < HEARTBEAT_US));
        if due && !silent {
            self.heartbeat = Some(now);
            send(&master_heartbeat(self.configuration.master_node));
        }
        let losses = self.counters.losses;
        self.watch(now, event, &mut |frame| {
            // A drive that is to stop by itself is not started again meanwhile.
            if !silent || *frame != start {
                send(frame);
            }
        });
        if self.counters.losses != losses {
            self.send_command(send);
        }
    }

    /// The traction drive does not follow its commands (FG-REQ-055).
    fn has_following_error(&mut self, now: Stamp) -> bool {
        let ordered_mps = match self.drives.commanded() {
            DriveCommand::Move { wheel_mps, .. } if wheel_mps.is_finite() => wheel_mps,
            _ => 0.0,
        };
        let ramp_mps2 = self.configuration.deceleration_mps2.min(self.configuration.quick_stop_mps2);
        self.following_error.watch(ordered_mps, self.drives.traction_mps(), ramp_mps2, now)
    }

    fn watch(&mut self, now: Stamp, event: &mut impl FnMut(BaseEvent), send: &mut impl FnMut(&CanFrame)) {
        let devices =
            [&mut self.traction, &mut self.steering, &mut self.left, &mut self.right, &mut self.inputs];
        let lost = devices.map(|device| device.poll(now, send).then_some(device.node()));
        for node in lost.into_iter().flatten() {
            self.counters.losses = self.counters.losses.saturating_add(1);
            self.on_loss(node);
            event(BaseEvent::NodeLost(node));
        }
    }

    fn on_loss(&mut self, node: u8) {
        let bus = &self.configuration;
        match node {
            node if node == bus.traction_node => self.drives.forget(Axis::Traction),
            node if node == bus.steering_node => self.drives.forget(Axis::Steering),
            node if node == bus.left_encoder_node => self.encoders.restart(Side::Left),
            node if node == bus.right_encoder_node => self.encoders.restart(Side::Right),
            _ => {}
        }
    }

    /// What the drives are to do from now on; goes out with the next poll or [`Self::send_command`].
    pub fn command(&mut self, command: DriveCommand) {
        self.drives.command(command);
    }

    /// The last command to the drives.
    #[must_use]
    pub const fn commanded(&self) -> DriveCommand {
        self.drives.commanded()
    }

    /// Sends the command at once: a stop does not wait for the next poll.
    ///
    /// A drive that is not operational, as far as is known, is commanded to stop: perhaps only its answers are
    /// lost, and the master's heartbeat keeps its own watchdog quiet.
    pub fn send_command(&self, send: &mut impl FnMut(&CanFrame)) {
        let (traction, steering) = (self.configuration.traction_node, self.configuration.steering_node);
        send(&if self.traction.is_operational() {
            self.drives.traction_frame(traction)
        } else {
            self.drives.traction_stop_frame(traction)
        });
        let steering_frame = if self.steering.is_operational() {
            self.drives.steering_frame(steering)
        } else {
            self.drives.steering_stop_frame(steering)
        };
        if let Some(frame) = steering_frame {
            send(&frame);
        }
    }

    /// The operator asked for a reset: drives in a fault are led out of it.
    pub fn reset_faults(&mut self) {
        self.drives.reset_faults();
    }

    /// Node numbers, ramps and the map of the input bits are what they were at the start; `false` after a flipped bit. Call it
    /// with each poll.
    #[must_use]
    pub fn is_whole(&self) -> bool {
        self.configuration == self.copy && self.image.is_of(&self.copy.inputs)
    }

    /// All five devices are operational.
    #[must_use]
    pub fn is_complete(&self) -> bool {
        self.devices().iter().all(|device| device.is_operational())
    }

    /// The devices, for display: traction, steering, left and right encoder, gateway.
    #[must_use]
    pub fn devices(&self) -> [&NodeConfigurator; 5] {
        [&self.traction, &self.steering, &self.left, &self.right, &self.inputs]
    }

    /// What was ignored.
    #[must_use]
    pub const fn counters(&self) -> BaseCounters {
        self.counters
    }

    fn device(&mut self, node: u8) -> Option<&mut NodeConfigurator> {
        [&mut self.traction, &mut self.steering, &mut self.left, &mut self.right, &mut self.inputs]
            .into_iter()
            .find(|device| device.node() == node)
    }

    /// Another master has set this device up before: this one was away (FG-REQ-018).
    fn on_found(&self, node: u8, event: &mut impl FnMut(BaseEvent)) {
        if node == self.configuration.traction_node {
            event(BaseEvent::FoundRunning);
        }
    }

    fn on_emergency(&mut self, node: u8, payload: &[u8], event: &mut impl FnMut(BaseEvent)) {
        // 080h itself is SYNC.
        let Some(emergency) = Emergency::decode(payload).filter(|_| node != 0) else { return };
        if node == self.configuration.traction_node {
            self.drives.on_emergency(Axis::Traction, emergency.code);
        } else if node == self.configuration.steering_node {
            self.drives.on_emergency(Axis::Steering, emergency.code);
        }
        event(BaseEvent::Emergency(node, emergency));
    }

    fn on_process_data(&mut self, node: u8, payload: &[u8], now: Stamp, event: &mut impl FnMut(BaseEvent)) {
        let bus = self.configuration;
        if node == bus.inputs_node {
            self.on_image(node, (0, payload), now, event);
        } else if node == bus.traction_node {
            self.on_drive(Axis::Traction, payload, now, event);
        } else if node == bus.steering_node {
            self.on_drive(Axis::Steering, payload, now, event);
        } else if node == bus.left_encoder_node {
            self.on_encoder(Side::Left, payload, now, event);
        } else if node == bus.right_encoder_node {
            self.on_encoder(Side::Right, payload, now, event);
        } else if Some(node) == bus.dirt_sensor_node {
            self.on_dirt(payload, now, event);
        }
    }

    /// Count so far, flags, number of the message; longer messages may say more than is known here.
    fn on_dirt(&mut self, payload: &[u8], now: Stamp, event: &mut impl FnMut(BaseEvent)) {
        let Some(&[low, high, flags, sequence]) = payload.first_chunk::<4>() else {
            self.counters.refused = self.counters.refused.saturating_add(1);
            return;
        };
        let count = u16::from_le_bytes([low, high]);
        event(BaseEvent::Dirt(DirtReading { stamp: now, count, brush_turns: flags & 1 != 0, sequence }));
    }

    fn on_image(
        &mut self,
        node: u8,
        (object, payload): (usize, &[u8]),
        now: Stamp,
        event: &mut impl FnMut(BaseEvent),
    ) {
        if node == self.configuration.inputs_node
            && let Some(inputs) = self.image.take(object, payload, now)
        {
            event(BaseEvent::Inputs(inputs));
        }
    }

    fn on_drive(&mut self, axis: Axis, payload: &[u8], now: Stamp, event: &mut impl FnMut(BaseEvent)) {
        match self.drives.on_report(axis, payload, now) {
            Ok(Some(feedback)) => event(BaseEvent::Drive(feedback)),
            Ok(None) => {}
            Err(()) => self.counters.refused = self.counters.refused.saturating_add(1),
        }
    }

    fn on_encoder(&mut self, side: Side, payload: &[u8], now: Stamp, event: &mut impl FnMut(BaseEvent)) {
        let encoder = match side {
            Side::Left => &self.left,
            Side::Right => &self.right,
        };
        // Before the range is known a position means nothing.
        let (Some(report), Some(range)) = (EncoderReport::decode(payload), encoder.read(0)) else {
            self.counters.refused = self.counters.refused.saturating_add(1);
            return;
        };
        // A range of 0 stands for the whole word.
        if range != 0 && report.position >= range {
            self.counters.refused = self.counters.refused.saturating_add(1);
            return;
        }
        if !matches!(self.latched.age(now), Age::Past(us) if us <= LATE_US) {
            self.counters.late = self.counters.late.saturating_add(1);
            return;
        }
        let reading = EncoderReading { position: report.position, range };
        if let Some(sample) = self.encoders.on_position(side, reading, self.latched) {
            event(BaseEvent::Wheels(sample));
        }
    }
}
