//! Roboteq by CANopen: controllers of one or two channels. No object of theirs is the watchdog: a script in the controller reads it and
//! shows it in a variable, and nothing drives before it does.

use floorguard_types::number::{nearest_f32, saturating_i32, truncating_u8};
use floorguard_types::time::Stamp;

use super::configuration::MotorDrivesConfiguration;
use super::link::{Order, Taken, Wheels};
use super::roboteq_link::FAULT_CODE;
use super::wheel::{Condition, Wheel};
use crate::can::CanFrame;
use crate::canopen::{ConfigurationFailure, NodeConfigurator, NodePhase};
use crate::roboteq::{
    BUS_CHANNELS, EMERGENCY_STOPPED, RoboteqBusOrder, RoboteqBusReport, SCRIPT_RUNS, bus_script,
};
use crate::wheel_drives::configuration::WHEELS_MAX;

/// Controllers that there are at most.
const CONTROLLERS_MAX: usize = 2;
/// Seconds of a minute.
const MINUTE_S: f32 = 60.0;
/// What changes a state is sent again after so many polls, 10 ms apart: the flags come each 20 ms.
const ASK_POLLS: u8 = 5;
/// Payload of an SDO answer that refuses.
const ABORT: u8 = 0x80;

/// A controller and its wheels.
#[derive(Clone, Debug)]
struct Controller {
    configurator: NodeConfigurator,
    /// The wheels of its channels, in their order.
    wheels: [Option<usize>; BUS_CHANNELS],
    is_watchdog_set: bool,
}

impl Controller {
    fn channels(&self) -> usize {
        self.wheels.iter().flatten().count()
    }

    /// The wheels of its channels.
    fn each<'a>(&self, wheels: &'a Wheels) -> impl Iterator<Item = &'a Wheel> {
        self.wheels.into_iter().flatten().filter_map(|index| wheels.get(index))
    }

    fn are_all(&self, wheels: &Wheels, condition: Condition) -> bool {
        self.each(wheels).all(|wheel| wheel.condition == condition)
    }

    /// It does not do any more what it was commanded.
    fn leave(&mut self, wheels: &mut Wheels) {
        self.is_watchdog_set = false;
        for index in self.wheels.into_iter().flatten() {
            if let Some(wheel) = wheels.get_mut(index).filter(|wheel| wheel.condition == Condition::On) {
                wheel.condition = Condition::Off;
            }
        }
    }

    /// Turns of its motors a minute.
    fn speeds(&self, speeds_mps: [f32; WHEELS_MAX], bus: &MotorDrivesConfiguration) -> RoboteqBusOrder {
        let rpm = self.wheels.map(|wheel| {
            let Some((index, mps)) = wheel.and_then(|index| Some((index, speeds_mps.get(index)?))) else {
                return 0;
            };
            saturating_i32(libm::roundf(mps / bus.travel_m(index) * MINUTE_S))
        });
        RoboteqBusOrder::Speeds { rpm, channels: self.channels() }
    }

    fn hear(
        &mut self,
        report: RoboteqBusReport,
        (now, bus): (Stamp, &MotorDrivesConfiguration),
        wheels: &mut Wheels,
    ) {
        for (channel, index) in self.wheels.into_iter().enumerate() {
            let Some((index, wheel)) = index.and_then(|index| Some((index, wheels.get_mut(index)?))) else {
                continue;
            };
            let travel_m = bus.travel_m(index);
            let of_channel = |values: [i32; BUS_CHANNELS]| values.get(channel).copied().unwrap_or_default();
            match report {
                RoboteqBusReport::Counts(counts) => wheel.count(of_channel(counts), travel_m < 0.0, now),
                RoboteqBusReport::Speeds(rpm) => {
                    wheel.speed(nearest_f32(of_channel(rpm)) / MINUTE_S * travel_m);
                }
                RoboteqBusReport::State { faults, .. } => {
                    wheel.heard = Some(now);
                    wheel.condition = match faults {
                        0 => Condition::On,
                        EMERGENCY_STOPPED => Condition::Off,
                        flags => Condition::Fault(FAULT_CODE | (flags & !EMERGENCY_STOPPED & 0xFF)),
                    };
                }
            }
        }
        if let RoboteqBusReport::State { status, watchdog_ms, .. } = report {
            let is_in_time = (1..=i32::from(bus.watchdog_ms)).contains(&watchdog_ms);
            self.is_watchdog_set = status & SCRIPT_RUNS != 0 && is_in_time;
        }
    }
}

#[derive(Clone, Debug, Default)]
pub(super) struct RoboteqBusLink {
    controllers: [Option<Controller>; CONTROLLERS_MAX],
    polls: u8,
}

impl RoboteqBusLink {
    /// Wheels with one number are the channels of one controller, in the order of the wheels. Wheels beyond two controllers or two channels
    /// have none, and are never heard: nothing drives.
    pub fn new(bus: &MotorDrivesConfiguration) -> Self {
        let mut controllers: [Option<(u8, [Option<usize>; BUS_CHANNELS])>; CONTROLLERS_MAX] =
            [None; CONTROLLERS_MAX];
        for (wheel, node) in bus.nodes.into_iter().enumerate().take(bus.wheel_count()) {
            let place = controllers.iter_mut().find(|known| known.is_none_or(|(number, _)| number == node));
            let Some(place) = place else { continue };
            let (_, channels) = place.get_or_insert((node, [None; BUS_CHANNELS]));
            if let Some(channel) = channels.iter_mut().find(|channel| channel.is_none()) {
                *channel = Some(wheel);
            }
        }
        let controllers = controllers.map(|known| {
            let (node, wheels) = known?;
            let script = bus_script(node, wheels.iter().flatten().count());
            let configurator = NodeConfigurator::new(node, script);
            Some(Controller { configurator, wheels, is_watchdog_set: false })
        });
        Self { controllers, polls: 0 }
    }

    pub fn take(
        &mut self,
        frame: &CanFrame,
        (now, bus): (Stamp, &MotorDrivesConfiguration),
        wheels: &mut Wheels,
    ) -> Taken {
        let Some(id) = frame.standard_id() else { return Taken::Another };
        let node = truncating_u8(id & 0x7F);
        let mut known = self.controllers.iter_mut().flatten();
        let Some(controller) = known.find(|known| known.configurator.node() == node) else {
            return Taken::Another;
        };
        match id & 0x780 {
            0x180 | 0x280 | 0x380 => {
                let Some((_, report)) = RoboteqBusReport::decode(frame, controller.channels()) else {
                    return Taken::Refused;
                };
                // What a former master made it send may mean something else.
                if controller.configurator.is_operational() {
                    controller.hear(report, (now, bus), wheels);
                }
            }
            0x580 => {
                let _ = controller.configurator.on_answer(frame.payload(), now);
                if frame.payload().first() == Some(&ABORT) {
                    return Taken::Refused;
                }
            }
            0x700 => {
                let byte = frame.payload().first().copied().unwrap_or(u8::MAX);
                let _ = controller.configurator.on_heartbeat(byte, now);
            }
            _ => return Taken::Another,
        }
        Taken::Understood
    }

    /// Ten milliseconds have passed: what the configuration of the controllers needs.
    pub fn attend(&mut self, now: Stamp, wheels: &mut Wheels, send: &mut impl FnMut(&CanFrame)) {
        self.polls = if self.polls >= ASK_POLLS { 1 } else { self.polls.saturating_add(1) };
        for controller in self.controllers.iter_mut().flatten() {
            // It has started anew, was taken out of operation, or is silent: whatever it was commanded is forgotten.
            if controller.configurator.poll(now, send) {
                controller.leave(wheels);
            }
        }
    }

    pub fn send(
        &self,
        order: &Order,
        (bus, wheels): (&MotorDrivesConfiguration, &Wheels),
        send: &mut impl FnMut(&CanFrame),
    ) {
        let asks = self.polls >= ASK_POLLS;
        for controller in self.controllers.iter().flatten() {
            if !controller.configurator.is_operational() {
                continue;
            }
            let mut tell = |order: RoboteqBusOrder| send(&order.frame(controller.configurator.node()));
            let still = controller.speeds([0.0; WHEELS_MAX], bus);
            let is_on = controller.are_all(wheels, Condition::On);
            match order.operate {
                true if is_on => tell(controller.speeds(order.speeds_mps, bus)),
                // A command that is taken wakes the speeds from before the watchdog acted: they are overwritten first.
                true => {
                    tell(still);
                    if asks {
                        tell(RoboteqBusOrder::Release);
                    }
                }
                false if is_on || (asks && !controller.are_all(wheels, Condition::Off)) => {
                    tell(still);
                    tell(RoboteqBusOrder::EmergencyStop);
                }
                _ => {}
            }
        }
    }

    pub fn send_emergency(&self, send: &mut impl FnMut(&CanFrame)) {
        for controller in self.controllers.iter().flatten() {
            send(&RoboteqBusOrder::EmergencyStop.frame(controller.configurator.node()));
        }
    }

    pub fn refusal(&self, node: u8) -> Option<ConfigurationFailure> {
        let mut known = self.controllers.iter().flatten().map(|controller| &controller.configurator);
        let refused = known.find(|known| known.node() == node && known.phase() == NodePhase::Refused)?;
        refused.failure()
    }

    /// They may be others, or may have lost their settings.
    pub fn forget(&mut self) {
        self.controllers.iter_mut().flatten().for_each(|controller| controller.is_watchdog_set = false);
    }

    /// Every controller shows a watchdog that acts in time.
    pub fn is_watchdog_set(&self) -> bool {
        let mut known = self.controllers.iter().flatten().peekable();
        known.peek().is_some() && known.all(|controller| controller.is_watchdog_set)
    }
}
