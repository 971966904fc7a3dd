//! An axis of an ODrive, firmware 0.6: heartbeat every 100 ms, estimates every 10 ms, a watchdog that disarms it.

use super::bank::Turning;
use crate::can::CanFrame;

const IDLE: u8 = 1;
const CLOSED_LOOP: u8 = 8;
/// Bits of `ODrive.Error`.
const UNDER_VOLTAGE: u32 = 0x200;
const WATCHDOG_EXPIRED: u32 = 0x0100_0000;
const EMERGENCY_STOP: u32 = 0x0200_0000;
/// Control by velocity, input as it comes.
const BY_VELOCITY: [u8; 8] = [2, 0, 0, 0, 1, 0, 0, 0];
const HEARTBEAT_US: u64 = 100_000;
const ESTIMATES_US: u64 = 10_000;

#[derive(Clone, Debug)]
pub(super) struct OdriveAxis {
    node: u8,
    state: u8,
    error: u32,
    follows_velocity: bool,
    input_turns_per_s: f32,
    fed_us: u64,
    silence_us: u64,
    next_us: [u64; 2],
}

impl OdriveAxis {
    pub fn new(node: u8, silence_us: u64) -> Self {
        // Axes are powered together, but send in their own rhythm.
        let next_us = [u64::from(node) * 13_000, u64::from(node) * 3_000];
        Self {
            node,
            state: IDLE,
            error: 0,
            follows_velocity: false,
            input_turns_per_s: 0.0,
            fed_us: 0,
            silence_us,
            next_us,
        }
    }

    pub fn receive(&mut self, frame: &CanFrame, now_us: u64) {
        if frame.extended || frame.id >> 5 != u32::from(self.node) {
            return;
        }
        let data = frame.data;
        match frame.id & 0x1F {
            0x02 => self.disarm(EMERGENCY_STOP),
            0x07 => match data[0] {
                CLOSED_LOOP if self.error == 0 && self.follows_velocity => {
                    (self.state, self.fed_us) = (CLOSED_LOOP, now_us);
                }
                CLOSED_LOOP => {}
                _ => self.state = IDLE,
            },
            0x0B => self.follows_velocity = data == BY_VELOCITY,
            0x0D => {
                self.input_turns_per_s = f32::from_le_bytes([data[0], data[1], data[2], data[3]]);
                self.fed_us = now_us;
            }
            0x18 => self.error = 0,
            _ => {}
        }
    }

    fn disarm(&mut self, error: u32) {
        (self.state, self.error) = (IDLE, self.error | error);
    }

    pub fn cut_power(&mut self) {
        if self.state == CLOSED_LOOP {
            self.disarm(UNDER_VOLTAGE);
        }
    }

    pub fn demand_turns_per_s(&self) -> Option<f32> {
        (self.state == CLOSED_LOOP).then_some(self.input_turns_per_s)
    }

    pub fn tick(&mut self, now_us: u64, turning: Turning, out: &mut Vec<CanFrame>) {
        let is_silent = self.silence_us > 0 && now_us > self.fed_us + self.silence_us;
        if self.state == CLOSED_LOOP && is_silent {
            self.disarm(WATCHDOG_EXPIRED);
        }
        let id = u32::from(self.node) << 5;
        if now_us >= self.next_us[0] {
            self.next_us[0] += HEARTBEAT_US;
            let [a, b, c, d] = self.error.to_le_bytes();
            out.push(CanFrame::new(id | 0x01, &[a, b, c, d, self.state, 0, 0, 0]));
        }
        if now_us >= self.next_us[1] {
            self.next_us[1] += ESTIMATES_US;
            let numbers = [turning.turns, turning.turns_per_s].map(f32::to_le_bytes).concat();
            out.push(CanFrame::new(id | 0x09, &numbers));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Frames of the maker's DBC file, as `cantools` encodes them.
    #[test]
    fn frames_are_those_of_the_maker() {
        let mut axis = OdriveAxis::new(3, 0);
        let mut out = Vec::new();
        let turning = Turning { turns: -12.375, turns_per_s: 0.8, counts: 0 };
        axis.tick(1_000_000, turning, &mut out);
        assert_eq!(
            out,
            [
                CanFrame::new(0x061, &[0, 0, 0, 0, 1, 0, 0, 0]),
                CanFrame::new(0x069, &[0x00, 0x00, 0x46, 0xC1, 0xCD, 0xCC, 0x4C, 0x3F]),
            ]
        );
    }

    #[test]
    fn silence_disarms() {
        let mut axis = OdriveAxis::new(1, 200_000);
        axis.receive(&CanFrame::new(0x02B, &BY_VELOCITY), 0);
        axis.receive(&CanFrame::new(0x027, &[8, 0, 0, 0, 0, 0, 0, 0]), 0);
        axis.receive(&CanFrame::new(0x02D, &[0, 0, 0xA0, 0xBF, 0, 0, 0, 0]), 0);
        assert_eq!(axis.demand_turns_per_s(), Some(-1.25));
        axis.tick(200_000, Turning::default(), &mut Vec::new());
        assert!(axis.demand_turns_per_s().is_some());
        axis.tick(201_000, Turning::default(), &mut Vec::new());
        assert_eq!((axis.demand_turns_per_s(), axis.error), (None, WATCHDOG_EXPIRED));
    }
}
