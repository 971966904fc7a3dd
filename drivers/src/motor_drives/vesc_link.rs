//! VESC: a controller a wheel. It has no state to climb to, and its status says nothing of a fault: one that reports is taken for
//! operating, and the watch over what the wheel does must find out.

use floorguard_types::number::{nearest_f32, saturating_i32};
use floorguard_types::time::Stamp;

use super::configuration::MotorDrivesConfiguration;
use super::link::{Order, Taken, Wheels};
use super::wheel::Condition;
use crate::can::CanFrame;
use crate::vesc::{VescMessage, VescOrder, VescReport};

/// Seconds of a minute.
const MINUTE_S: f32 = 60.0;

#[derive(Clone, Copy, Debug, Default)]
pub(super) struct VescLink;

impl VescLink {
    pub fn take(
        frame: &CanFrame,
        (now, bus): (Stamp, &MotorDrivesConfiguration),
        wheels: &mut Wheels,
    ) -> Taken {
        let Some([_, 0, _, node]) = frame.extended_id().map(u32::to_be_bytes) else { return Taken::Another };
        let Some(index) = bus.wheel_of(node) else { return Taken::Another };
        let Some(wheel) = wheels.get_mut(index) else { return Taken::Another };
        let Some(message) = VescMessage::decode(frame) else { return Taken::Refused };
        let travel_m = bus.travel_m(index);
        match message.report {
            VescReport::Motion { electrical_rpm, .. } => {
                let turns_per_s = nearest_f32(electrical_rpm) / bus.pole_pairs.max(1.0) / MINUTE_S;
                (wheel.heard, wheel.condition) = (Some(now), Condition::On);
                wheel.speed(turns_per_s * travel_m);
            }
            VescReport::Place { steps, .. } => wheel.count(steps, travel_m < 0.0, now),
            VescReport::Charge { .. } | VescReport::Energy { .. } | VescReport::Warmth { .. } => {}
        }
        Taken::Understood
    }

    pub fn send(order: &Order, bus: &MotorDrivesConfiguration, send: &mut impl FnMut(&CanFrame)) {
        let known = bus.nodes.iter().zip(order.speeds_mps).take(bus.wheel_count());
        for (index, (node, speed_mps)) in known.enumerate() {
            let turns_per_s = speed_mps / bus.travel_m(index);
            let rpm = saturating_i32(libm::roundf(turns_per_s * MINUTE_S * bus.pole_pairs.max(1.0)));
            let order = if order.operate { VescOrder::ElectricalRpm(rpm) } else { VescOrder::Current(0.0) };
            send(&order.frame(*node));
        }
    }
}
