//! A VESC: two status messages at 50 Hz each, a time after which it lets go.

use super::bank::Turning;
use crate::can::CanFrame;

const STATUS_US: u64 = 20_000;
/// Volts of the supply.
const SUPPLY_V: f32 = 24.0;

#[derive(Clone, Copy, Debug, PartialEq)]
enum Asked {
    Nothing,
    Rpm(i32),
}

#[derive(Clone, Debug)]
pub(super) struct VescController {
    node: u8,
    asked: Asked,
    fed_us: u64,
    silence_us: u64,
    next_us: u64,
}

impl VescController {
    pub fn new(node: u8, silence_us: u64) -> Self {
        Self { node, asked: Asked::Nothing, fed_us: 0, silence_us, next_us: u64::from(node) * 3_000 }
    }

    pub fn receive(&mut self, frame: &CanFrame, now_us: u64) {
        if !frame.extended || frame.id & 0xFF != u32::from(self.node) {
            return;
        }
        let [a, b, c, d, ..] = frame.data;
        let value = i32::from_be_bytes([a, b, c, d]);
        self.asked = match frame.id >> 8 {
            1 if value == 0 => Asked::Nothing,
            3 => Asked::Rpm(value),
            _ => return,
        };
        self.fed_us = now_us;
    }

    pub const fn cut_power(&mut self) {
        self.asked = Asked::Nothing;
    }

    pub fn demand_turns_per_s(&self, pole_pairs: f32) -> Option<f32> {
        match self.asked {
            Asked::Nothing => None,
            Asked::Rpm(rpm) => Some(rpm as f32 / pole_pairs / 60.0),
        }
    }

    pub fn tick(&mut self, now_us: u64, (turning, pole_pairs): (Turning, f32), out: &mut Vec<CanFrame>) {
        if self.silence_us > 0 && now_us > self.fed_us + self.silence_us {
            self.asked = Asked::Nothing;
        }
        if now_us < self.next_us {
            return;
        }
        self.next_us += STATUS_US;
        let rpm = (turning.turns_per_s * 60.0 * pole_pairs).round() as i32;
        let [a, b, c, d] = rpm.to_be_bytes();
        out.push(CanFrame::extended(9 << 8 | u32::from(self.node), &[a, b, c, d, 0, 0, 0, 0]));
        let steps = (turning.turns * 6.0 * pole_pairs).floor() as i32;
        let [a, b, c, d] = steps.to_be_bytes();
        let [e, f] = ((SUPPLY_V * 10.0) as i16).to_be_bytes();
        out.push(CanFrame::extended(27 << 8 | u32::from(self.node), &[a, b, c, d, e, f, 0, 0]));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn follows_electrical_turns_until_silence() {
        let mut controller = VescController::new(5, 200_000);
        // CAN_PACKET_SET_RPM with -3000, packed by Python's struct.
        controller.receive(&CanFrame::extended(0x0305, &[0xFF, 0xFF, 0xF4, 0x48]), 0);
        assert_eq!(controller.demand_turns_per_s(5.0), Some(-10.0));
        let turning = Turning { turns: 100.0, turns_per_s: -10.0, counts: 0 };
        let mut out = Vec::new();
        controller.tick(100_000, (turning, 5.0), &mut out);
        assert_eq!(out[0], CanFrame::extended(0x0905, &[0xFF, 0xFF, 0xF4, 0x48, 0, 0, 0, 0]));
        assert_eq!(out[1], CanFrame::extended(0x1B05, &[0, 0, 0x0B, 0xB8, 0, 0xF0, 0, 0]));
        controller.tick(201_000, (turning, 5.0), &mut out);
        assert_eq!(controller.demand_turns_per_s(5.0), None);
    }
}
