//! ODrive: an axis a wheel. It is armed when it is to operate, and its heartbeat shows when its watchdog has taken the torque away.

use floorguard_types::number::saturating_u16_of_u32;
use floorguard_types::time::Stamp;

use super::configuration::MotorDrivesConfiguration;
use super::link::{Order, Taken, Wheels};
use super::wheel::Condition;
use crate::can::CanFrame;
use crate::odrive::{AxisState, OdriveMessage, OdriveOrder, OdriveReport, WATCHDOG_EXPIRED};

/// What changes a state is sent each so many polls, 10 ms apart: an axis answers by its next heartbeat.
const ASK_POLLS: u8 = 10;
/// A fault is this and the number of the lowest bit of the axis error.
const FAULT_CODE: u16 = 0x0D00;

#[derive(Clone, Copy, Debug, Default)]
pub(super) struct OdriveLink {
    polls: u8,
}

impl OdriveLink {
    pub fn take(
        frame: &CanFrame,
        (now, bus): (Stamp, &MotorDrivesConfiguration),
        wheels: &mut Wheels,
    ) -> Taken {
        let Some(id) = frame.standard_id() else { return Taken::Another };
        let Some(index) = u8::try_from(id >> 5).ok().and_then(|node| bus.wheel_of(node)) else {
            return Taken::Another;
        };
        let Some(wheel) = wheels.get_mut(index) else { return Taken::Another };
        let Some(message) = OdriveMessage::decode(frame) else { return Taken::Refused };
        let travel_m = bus.travel_m(index);
        match message.report {
            OdriveReport::Heartbeat { error, state } => {
                wheel.heard = Some(now);
                wheel.condition = match (error, state) {
                    (0, AxisState::ClosedLoop) => Condition::On,
                    (0, _) => Condition::Off,
                    (WATCHDOG_EXPIRED, _) => Condition::Expired,
                    (error, _) => {
                        Condition::Fault(FAULT_CODE | saturating_u16_of_u32(error.trailing_zeros()))
                    }
                };
            }
            OdriveReport::Estimates { position_turns, speed_turns_per_s } => {
                wheel.speed(speed_turns_per_s * travel_m);
                wheel.count_turns(position_turns, bus.counts_per_turn, (travel_m < 0.0, now));
            }
            OdriveReport::Errors { .. } | OdriveReport::Bus { .. } => {}
        }
        Taken::Understood
    }

    pub fn step(&mut self) {
        self.polls = if self.polls >= ASK_POLLS { 1 } else { self.polls.saturating_add(1) };
    }

    pub fn send(
        &self,
        order: &Order,
        (bus, wheels): (&MotorDrivesConfiguration, &Wheels),
        send: &mut impl FnMut(&CanFrame),
    ) {
        let asks = self.polls >= ASK_POLLS;
        let known = bus.nodes.iter().zip(wheels).zip(order.speeds_mps);
        for (index, ((node, wheel), speed_mps)) in known.take(bus.wheel_count()).enumerate() {
            let mut tell = |order: OdriveOrder| send(&order.frame(*node));
            match wheel.condition {
                Condition::On if order.operate => tell(OdriveOrder::Speed(speed_mps / bus.travel_m(index))),
                // What is not known to be without torque is commanded so.
                Condition::On | Condition::Unknown => tell(OdriveOrder::Idle),
                Condition::Expired if asks && (order.operate || order.reset) => {
                    tell(OdriveOrder::ClearErrors)
                }
                Condition::Fault(_) if asks && order.reset => tell(OdriveOrder::ClearErrors),
                Condition::Off if asks && order.operate => {
                    tell(OdriveOrder::FollowSpeed);
                    tell(OdriveOrder::Speed(0.0));
                    tell(OdriveOrder::ClosedLoop);
                }
                // Armed meanwhile, perhaps: its watchdog is fed, at no speed, until its heartbeat says so.
                Condition::Off if order.operate => tell(OdriveOrder::Speed(0.0)),
                Condition::Off if asks => tell(OdriveOrder::Idle),
                _ => {}
            }
        }
    }

    pub fn send_emergency(bus: &MotorDrivesConfiguration, send: &mut impl FnMut(&CanFrame)) {
        bus.nodes
            .iter()
            .take(bus.wheel_count())
            .for_each(|node| send(&OdriveOrder::EmergencyStop.frame(*node)));
    }
}
