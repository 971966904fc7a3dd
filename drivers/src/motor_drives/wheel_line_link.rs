//! The wheel line: one controller for all wheels, which stops by itself after each request's deadline.

use floorguard_types::number::{nearest_f32, saturating_i32};
use floorguard_types::time::Stamp;

use super::configuration::MotorDrivesConfiguration;
use super::link::{Order, Taken, Wheels, send_bytes};
use super::wheel::Condition;
use crate::can::CanFrame;
use crate::text_lines::TextLines;
use crate::wheel_line::{WheelReport, WheelRequest, WheelState};

/// Code of a controller that says it cannot.
const FAULT_CODE: u16 = 0x0F00;

#[derive(Clone, Debug, Default)]
pub(super) struct WheelLineLink {
    lines: TextLines,
    sequence: u32,
    newest: Option<u32>,
}

impl WheelLineLink {
    pub fn take(
        &mut self,
        frame: &CanFrame,
        (now, bus): (Stamp, &MotorDrivesConfiguration),
        wheels: &mut Wheels,
    ) -> Taken {
        let mut taken = Taken::Understood;
        for byte in frame.payload() {
            let Some(line) = self.lines.byte(*byte) else { continue };
            let newest = self.newest;
            let is_newer = |report: &WheelReport| {
                let ahead = newest.map_or(1, |newest| report.sequence.wrapping_sub(newest));
                (1..1 << 31).contains(&ahead) && report.wheels.len() == bus.wheel_count()
            };
            match WheelReport::decode(line).ok().filter(is_newer) {
                Some(report) => {
                    self.newest = Some(report.sequence);
                    hear(&report, (now, bus), wheels);
                }
                None => taken = Taken::Refused,
            }
        }
        taken
    }

    /// What goes out next is a request of its own.
    pub const fn renew(&mut self) {
        self.sequence = self.sequence.wrapping_add(1);
    }

    /// The controller begins anew, and counts from the start.
    pub const fn forget(&mut self) {
        self.newest = None;
    }

    pub fn send(&self, order: &Order, bus: &MotorDrivesConfiguration, send: &mut impl FnMut(&CanFrame)) {
        let of_wheel = |(index, speed_mps): (usize, &f32)| {
            let sign = if bus.travel_m(index) < 0.0 { -1.0 } else { 1.0 };
            saturating_i32(libm::roundf(speed_mps * sign * 1_000.0))
        };
        let request = WheelRequest {
            sequence: self.sequence,
            deadline_ms: bus.watchdog_ms,
            follow: order.operate,
            speeds_mmps: order.speeds_mps.iter().enumerate().map(of_wheel).take(bus.wheel_count()).collect(),
        };
        send_bytes(request.encode().as_bytes(), send);
    }
}

fn hear(report: &WheelReport, (now, bus): (Stamp, &MotorDrivesConfiguration), wheels: &mut Wheels) {
    let condition = match report.state {
        WheelState::Off => Condition::Off,
        WheelState::Follows => Condition::On,
        WheelState::Expired => Condition::Expired,
        WheelState::Fault => Condition::Fault(FAULT_CODE),
    };
    let stamp = now.minus_micros(u64::from(report.age_ms).saturating_mul(1_000));
    for (index, (wheel, value)) in wheels.iter_mut().zip(&report.wheels).enumerate() {
        let is_reversed = bus.travel_m(index) < 0.0;
        let sign = if is_reversed { -1.0 } else { 1.0 };
        (wheel.heard, wheel.condition) = (Some(now), condition);
        wheel.speed(nearest_f32(value.speed_mmps) * 1.0e-3 * sign);
        wheel.count(value.count, is_reversed, stamp);
    }
}
