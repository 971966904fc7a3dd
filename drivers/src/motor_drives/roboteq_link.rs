//! Roboteq: a controller of two channels on a line. Its watchdog is set and read back before it may drive.

use floorguard_types::number::{nearest_f32, saturating_i32};
use floorguard_types::time::Stamp;

use super::configuration::MotorDrivesConfiguration;
use super::link::{Order, Taken, Wheels, send_bytes};
use super::wheel::Condition;
use crate::can::CanFrame;
use crate::roboteq::{EMERGENCY_STOPPED, RoboteqOrder, RoboteqReply};
use crate::text_lines::TextLines;

/// Seconds of a minute.
const MINUTE_S: f32 = 60.0;
/// Channels of a controller.
const CHANNELS: usize = 2;
/// It is asked each so many polls, 10 ms apart; the watchdog more seldom.
const ASK_POLLS: u8 = 2;
const SET_POLLS: u8 = 20;
/// A fault is this and its flags.
pub(super) const FAULT_CODE: u16 = 0x0E00;

#[derive(Clone, Debug, Default)]
pub(super) struct RoboteqLink {
    lines: TextLines,
    polls: u8,
    is_watchdog_set: bool,
}

impl RoboteqLink {
    pub fn take(
        &mut self,
        frame: &CanFrame,
        (now, bus): (Stamp, &MotorDrivesConfiguration),
        wheels: &mut Wheels,
    ) -> Taken {
        let mut taken = Taken::Understood;
        for byte in frame.payload() {
            let Some(line) = self.lines.byte(*byte) else { continue };
            match RoboteqReply::decode(line) {
                Some(RoboteqReply::Watchdog(ms)) => self.is_watchdog_set = ms == u32::from(bus.watchdog_ms),
                Some(RoboteqReply::Refused) => taken = Taken::Refused,
                Some(reply) => hear(reply, (now, bus), wheels),
                None => {}
            }
        }
        taken
    }

    pub fn step(&mut self) {
        self.polls = if self.polls >= SET_POLLS { 1 } else { self.polls.saturating_add(1) };
    }

    pub fn send(
        &self,
        order: &Order,
        (bus, wheels): (&MotorDrivesConfiguration, &Wheels),
        send: &mut impl FnMut(&CanFrame),
    ) {
        let mut tell = |order: RoboteqOrder| send_bytes(order.text().as_bytes(), send);
        let is_on = wheels.iter().take(CHANNELS).all(|wheel| wheel.condition == Condition::On);
        match (order.operate, is_on) {
            // A command that is taken wakes the speeds from before the watchdog acted: they are overwritten first.
            (true, false) => {
                for channel in (1..).take(CHANNELS) {
                    tell(RoboteqOrder::Speed { channel, rpm: 0 });
                }
                tell(RoboteqOrder::Release);
            }
            (false, _) => tell(RoboteqOrder::EmergencyStop),
            (true, true) => {
                for (index, (channel, speed_mps)) in (1..).zip(order.speeds_mps).take(CHANNELS).enumerate() {
                    let rpm = saturating_i32(libm::roundf(speed_mps / bus.travel_m(index) * MINUTE_S));
                    tell(RoboteqOrder::Speed { channel, rpm });
                }
            }
        }
        if self.polls.is_multiple_of(ASK_POLLS) {
            [RoboteqOrder::AskSpeeds, RoboteqOrder::AskCounts, RoboteqOrder::AskFaults]
                .into_iter()
                .for_each(&mut tell);
        }
        if self.polls >= SET_POLLS && !self.is_watchdog_set {
            tell(RoboteqOrder::SetWatchdog(bus.watchdog_ms));
            tell(RoboteqOrder::AskWatchdog);
        }
    }

    pub fn send_emergency(send: &mut impl FnMut(&CanFrame)) {
        send_bytes(RoboteqOrder::EmergencyStop.text().as_bytes(), send);
    }

    /// It may be another one, or may have lost its settings.
    pub const fn forget(&mut self) {
        self.is_watchdog_set = false;
    }

    pub const fn is_watchdog_set(&self) -> bool {
        self.is_watchdog_set
    }
}

fn hear(reply: RoboteqReply, (now, bus): (Stamp, &MotorDrivesConfiguration), wheels: &mut Wheels) {
    match reply {
        RoboteqReply::Speeds(rpm) => {
            for (index, (wheel, rpm)) in wheels.iter_mut().zip(rpm).enumerate() {
                wheel.speed(nearest_f32(rpm) / MINUTE_S * bus.travel_m(index));
            }
        }
        RoboteqReply::Counts(counts) => {
            for (index, (wheel, count)) in wheels.iter_mut().zip(counts).enumerate() {
                wheel.count(count, bus.travel_m(index) < 0.0, now);
            }
        }
        RoboteqReply::Faults(flags) => {
            let condition = match flags {
                0 => Condition::On,
                EMERGENCY_STOPPED => Condition::Off,
                flags => Condition::Fault(FAULT_CODE | (flags & !EMERGENCY_STOPPED & 0xFF)),
            };
            wheels
                .iter_mut()
                .take(CHANNELS)
                .for_each(|wheel| (wheel.heard, wheel.condition) = (Some(now), condition));
        }
        RoboteqReply::Watchdog(_) | RoboteqReply::Accepted | RoboteqReply::Refused => {}
    }
}

#[cfg(test)]
mod tests {
    use std::string::String;

    use super::*;

    /// Of a stopped controller: a release alone would let it go on as before its watchdog acted.
    #[test]
    fn speeds_of_before_are_overwritten_before_release() {
        let mut link = RoboteqLink::default();
        link.step();
        let order = Order { operate: true, ..Order::default() };
        let mut text = String::new();
        link.send(
            &order,
            (&MotorDrivesConfiguration::default(), &Wheels::default()),
            &mut |frame: &CanFrame| {
                text.extend(frame.payload().iter().map(|byte| char::from(*byte)));
            },
        );
        assert!(text.starts_with("!S 1 0\r!S 2 0\r!MG\r"), "{text}");
    }
}
