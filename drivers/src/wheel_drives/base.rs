//! The master of the bus: boots the devices, keeps them alive, translates both ways.
//!
//! Sans-I/O as [`ThreeWheelBase`](crate::three_wheel_base::ThreeWheelBase) is: frames in with [`WheelDrives::on_frame`], frames out from
//! [`WheelDrives::poll`] every 10 ms and, for a stop, from [`WheelDrives::send_command`] at once.

use floorguard_types::number::truncating_u8;
use floorguard_types::sensing::{DirtReading, WheelSample};
use floorguard_types::time::{Age, Stamp};

use super::configuration::{WHEELS_MAX, WheelDrivesConfiguration};
use super::drives::{WheelCommand, WheelGroup};
use crate::can::CanFrame;
use crate::canopen::{
    Emergency, NetworkCommand, NodeConfigurator, master_heartbeat, network_frame, sync_frame,
};
use crate::flexisoft::SafetyImage;
use crate::three_wheel_base::following_error::FollowingErrorMonitor;
use crate::three_wheel_base::{BaseConfiguration, BaseCounters, BaseEvent};

/// Heartbeat of the master, microseconds: a quarter of what the drives tolerate.
const HEARTBEAT_US: u64 = 50_000;
/// An answer to a SYNC that is later than this belongs to nothing, microseconds.
const LATE_US: u64 = 9_000;

/// Count of a wheel, which goes on where a drive begins anew.
#[derive(Clone, Copy, Debug, Default)]
struct WheelCount {
    total: i32,
    position: Option<i32>,
    /// Since the last SYNC.
    is_new: bool,
}

impl WheelCount {
    fn take(&mut self, position: i32) {
        let moved = self.position.map_or(0, |before| position.wrapping_sub(before));
        (self.total, self.position, self.is_new) = (self.total.wrapping_add(moved), Some(position), true);
    }
}

/// The drives of two or four wheels, and the gateway.
///
/// ```
/// use floorguard_drivers::three_wheel_base::StopKind;
/// use floorguard_drivers::wheel_drives::{WheelCommand, WheelDrives, WheelDrivesConfiguration};
/// use floorguard_types::time::Stamp;
///
/// let mut base = WheelDrives::new(WheelDrivesConfiguration::default());
/// assert_eq!(base.commanded(), WheelCommand::Stop(StopKind::TorqueOff));
/// // No device answers yet: the devices are called, and the base is not complete.
/// let mut identifiers = Vec::new();
/// base.poll(Stamp::ZERO, &mut |_| {}, &mut |frame| identifiers.extend(frame.standard_id()));
/// assert!(identifiers.contains(&0x201) && identifiers.contains(&0x202) && identifiers.contains(&0x77F));
/// assert_eq!((base.devices().count(), base.is_complete()), (3, false));
/// ```
#[derive(Clone, Debug)]
pub struct WheelDrives {
    configuration: WheelDrivesConfiguration,
    /// The same once more.
    copy: WheelDrivesConfiguration,
    nodes: [NodeConfigurator; WHEELS_MAX],
    inputs: NodeConfigurator,
    group: WheelGroup,
    counts: [WheelCount; WHEELS_MAX],
    image: SafetyImage,
    latched: Stamp,
    heartbeat: Option<Stamp>,
    following_error: FollowingErrorMonitor,
    counters: BaseCounters,
}

impl WheelDrives {
    /// No device was heard yet; the drives are to have no torque.
    #[must_use]
    pub fn new(configuration: WheelDrivesConfiguration) -> Self {
        let drive = |node| NodeConfigurator::new(node, configuration.wheel_script(node));
        Self {
            nodes: configuration.wheel_nodes.map(drive),
            inputs: NodeConfigurator::new(configuration.inputs_node, BaseConfiguration::inputs_script()),
            group: WheelGroup::new(configuration.wheels()),
            counts: [WheelCount::default(); WHEELS_MAX],
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
        let (node, payload) = (truncating_u8(id & 0x7F), frame.payload());
        match id & 0x780 {
            0x080 => self.on_emergency(node, payload, event),
            0x180 | 0x280 | 0x380 | 0x480 => {
                self.on_process_data(
                    usize::from((id >> 8) & 7).saturating_sub(1),
                    (node, payload),
                    now,
                    event,
                );
            }
            0x580 if self.device(node).is_some_and(|device| device.on_answer(payload, now)) => {
                self.on_found(node, event);
            }
            0x700 => {
                let byte = payload.first().copied().unwrap_or(u8::MAX);
                if self.device(node).is_some_and(|device| device.on_heartbeat(byte, now)) {
                    self.on_found(node, event);
                }
            }
            _ => {}
        }
    }

    /// Ten milliseconds have passed: a step of the ramp, commands, SYNC, heartbeat, and whatever the devices' start needs.
    pub fn poll(&mut self, now: Stamp, event: &mut impl FnMut(BaseEvent), send: &mut impl FnMut(&CanFrame)) {
        let bus = self.configuration;
        self.group.step(&bus);
        // The command first: a serial line sends in order, and nothing may hold a stop up.
        self.send_command(send);
        let (ordered_mps, ramp_mps2) = (self.group.target_mps(), bus.deceleration_mps2);
        let silent = self.following_error.watch(ordered_mps, self.group.fastest_mps(), ramp_mps2, now);
        if silent {
            self.counters.silences = self.counters.silences.saturating_add(1);
            // They may obey the next frame that reaches them; what counts is their own watch over the heartbeat (FG-REQ-055).
            self.wheel_nodes().for_each(|node| send(&network_frame(NetworkCommand::Stop, node)));
        }
        self.counts.iter_mut().for_each(|count| count.is_new = false);
        self.latched = now;
        send(&sync_frame());
        let due =
            self.heartbeat.is_none_or(|sent| !matches!(sent.age(now), Age::Past(us) if us < HEARTBEAT_US));
        if due && !silent {
            self.heartbeat = Some(now);
            send(&master_heartbeat(bus.master_node));
        }
        let losses = self.counters.losses;
        let starts = bus.wheel_nodes.map(|node| network_frame(NetworkCommand::Start, node));
        self.watch(now, event, &mut |frame| {
            // A drive that is to stop by itself is not started again meanwhile.
            if !silent || !starts.contains(frame) {
                send(frame);
            }
        });
        if self.counters.losses != losses {
            self.send_command(send);
        }
    }

    fn wheel_nodes(&self) -> impl Iterator<Item = u8> + use<> {
        self.configuration.wheel_nodes.into_iter().take(self.configuration.wheels().min(WHEELS_MAX))
    }

    fn watch(&mut self, now: Stamp, event: &mut impl FnMut(BaseEvent), send: &mut impl FnMut(&CanFrame)) {
        let wheels = self.configuration.wheels().min(WHEELS_MAX);
        let (mut losses, group, counts) = (0_u32, &mut self.group, &mut self.counts);
        for (wheel, device) in self.nodes.iter_mut().take(wheels).enumerate() {
            if device.poll(now, send) {
                group.forget(wheel);
                // Its wheel may have turned any way meanwhile.
                counts.iter_mut().skip(wheel).take(1).for_each(|count| count.position = None);
                losses = losses.saturating_add(1);
                event(BaseEvent::NodeLost(device.node()));
            }
        }
        if self.inputs.poll(now, send) {
            losses = losses.saturating_add(1);
            event(BaseEvent::NodeLost(self.inputs.node()));
        }
        self.counters.losses = self.counters.losses.saturating_add(losses);
    }

    /// What the wheels are to do from now on; goes out with the next poll or [`Self::send_command`]. The first step of a stop is taken
    /// here, so that what is sent at once is slower already.
    pub fn command(&mut self, command: WheelCommand) {
        let (was_moving, bus) = (matches!(self.group.commanded(), WheelCommand::Move(_)), self.configuration);
        self.group.command(command);
        if was_moving && matches!(command, WheelCommand::Stop(_)) {
            self.group.ramp(&bus);
        }
    }

    /// The last command to the wheels.
    #[must_use]
    pub const fn commanded(&self) -> WheelCommand {
        self.group.commanded()
    }

    /// Sends the command at once: a stop does not wait for the next poll. A drive that is not operational, as far as is known, is
    /// commanded to stop.
    pub fn send_command(&self, send: &mut impl FnMut(&CanFrame)) {
        for (wheel, (node, device)) in self.wheel_nodes().zip(&self.nodes).enumerate() {
            let frame = if device.is_operational() {
                self.group.frame(wheel, node)
            } else {
                self.group.stop_frame(node)
            };
            send(&frame);
        }
    }

    /// The operator asked for a reset: drives in a fault are led out of it.
    pub fn reset_faults(&mut self) {
        self.group.reset_faults();
    }

    /// Node numbers, ramps, geometry and the map of the input bits are what they were at the start; `false` after a flipped bit.
    /// Call it with each poll.
    #[must_use]
    pub fn is_whole(&self) -> bool {
        self.configuration == self.copy && self.image.is_of(&self.copy.inputs)
    }

    /// All devices are operational.
    #[must_use]
    pub fn is_complete(&self) -> bool {
        self.devices().all(NodeConfigurator::is_operational)
    }

    /// The devices, for display: drives of the wheels in their order, then the gateway.
    pub fn devices(&self) -> impl Iterator<Item = &NodeConfigurator> {
        self.nodes.iter().take(self.configuration.wheels()).chain([&self.inputs])
    }

    /// What was ignored.
    #[must_use]
    pub const fn counters(&self) -> BaseCounters {
        self.counters
    }

    fn device(&mut self, node: u8) -> Option<&mut NodeConfigurator> {
        let wheels = self.configuration.wheels();
        self.nodes.iter_mut().take(wheels).chain([&mut self.inputs]).find(|device| device.node() == node)
    }

    fn wheel_of(&self, node: u8) -> Option<usize> {
        self.wheel_nodes().position(|known| known == node)
    }

    /// Another master has set this drive up before: this one was away (FG-REQ-018).
    fn on_found(&self, node: u8, event: &mut impl FnMut(BaseEvent)) {
        if self.wheel_of(node).is_some() {
            event(BaseEvent::FoundRunning);
        }
    }

    fn on_emergency(&mut self, node: u8, payload: &[u8], event: &mut impl FnMut(BaseEvent)) {
        // 080h itself is SYNC.
        let Some(emergency) = Emergency::decode(payload).filter(|_| node != 0) else { return };
        if let Some(wheel) = self.wheel_of(node) {
            self.group.on_emergency(wheel, emergency.code);
        }
        event(BaseEvent::Emergency(node, emergency));
    }

    fn on_process_data(
        &mut self,
        object: usize,
        (node, payload): (u8, &[u8]),
        now: Stamp,
        event: &mut impl FnMut(BaseEvent),
    ) {
        if node == self.configuration.inputs_node {
            if let Some(inputs) = self.image.take(object, payload, now) {
                event(BaseEvent::Inputs(inputs));
            }
            return;
        }
        if object == 0 && Some(node) == self.configuration.dirt_sensor_node {
            return self.on_dirt(payload, now, event);
        }
        match (self.wheel_of(node), object) {
            (Some(wheel), 0) => {
                let bus = self.configuration;
                match self.group.on_report(wheel, payload, (now, &bus)) {
                    Ok(Some(feedback)) => event(BaseEvent::Drive(feedback)),
                    Ok(None) => {}
                    Err(()) => self.refuse(),
                }
            }
            (Some(wheel), 1) => self.on_position(wheel, payload, now, event),
            _ => {}
        }
    }

    fn refuse(&mut self) {
        self.counters.refused = self.counters.refused.saturating_add(1);
    }

    fn on_position(&mut self, wheel: usize, payload: &[u8], now: Stamp, event: &mut impl FnMut(BaseEvent)) {
        let Some(bytes) = payload.first_chunk::<4>() else { return self.refuse() };
        if !matches!(self.latched.age(now), Age::Past(us) if us <= LATE_US) {
            self.counters.late = self.counters.late.saturating_add(1);
            return;
        }
        if let Some(count) = self.counts.get_mut(wheel) {
            count.take(i32::from_le_bytes(*bytes));
        }
        let wheels = self.configuration.wheels();
        if !self.counts.iter().take(wheels).all(|count| count.is_new) {
            return;
        }
        self.counts.iter_mut().for_each(|count| count.is_new = false);
        let side = |first: usize| {
            let counts = self.counts.iter().take(wheels).skip(first).step_by(2);
            counts.fold(0_i32, |sum, count| sum.wrapping_add(count.total))
        };
        event(BaseEvent::Wheels(WheelSample {
            stamp: self.latched,
            left_ticks: side(0),
            right_ticks: side(1),
        }));
    }

    /// Count so far, flags, number of the message; longer messages may say more than is known here.
    fn on_dirt(&mut self, payload: &[u8], now: Stamp, event: &mut impl FnMut(BaseEvent)) {
        let Some(&[low, high, flags, sequence]) = payload.first_chunk::<4>() else { return self.refuse() };
        let count = u16::from_le_bytes([low, high]);
        event(BaseEvent::Dirt(DirtReading { stamp: now, count, brush_turns: flags & 1 != 0, sequence }));
    }
}
