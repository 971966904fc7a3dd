//! The safety controller's gateway: the process image of the inputs (book, Safety inputs).
//!
//! Factory identifiers, sent every 10 ms while operational. TPDO1 bytes 4–7 are the inputs. Byte 4: bits 0 and 1 the
//! emergency stop's two channels, 2 and 3 the front bumper's, 4 and 5 the rear bumper's. Byte 5: bit 0 floor seen at
//! the front, bit 1 at the rear. 1 is the operating state everywhere, so a cut wire reads as danger.

use super::{CanFrame, Node};

const PERIOD_US: u64 = 10_000;

/// What the switches do; `true` is the operating state of a channel.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct SafetyChannels {
    /// Two channels of the emergency stop.
    pub emergency_stop: [bool; 2],
    /// Two channels of the front bumper.
    pub bumper_front: [bool; 2],
    /// Two channels of the rear bumper.
    pub bumper_rear: [bool; 2],
    /// Floor present at the front and at the rear.
    pub floor: [bool; 2],
}

impl Default for SafetyChannels {
    fn default() -> Self {
        Self { emergency_stop: [true; 2], bumper_front: [true; 2], bumper_rear: [true; 2], floor: [true; 2] }
    }
}

impl SafetyChannels {
    fn input_bytes(self) -> [u8; 2] {
        let pair = |pair: [bool; 2], shift: u8| (u8::from(pair[0]) | u8::from(pair[1]) << 1) << shift;
        let switches = pair(self.emergency_stop, 0) | pair(self.bumper_front, 2) | pair(self.bumper_rear, 4);
        [switches, pair(self.floor, 0)]
    }
}

/// The gateway on the bus.
#[derive(Clone, Debug)]
pub struct Gateway {
    /// The bus side.
    pub node: Node,
    next_us: u64,
}

impl Gateway {
    /// A gateway that has just been powered.
    #[must_use]
    pub fn new(id: u8) -> Self {
        Self { node: Node::new(id, 0), next_us: 0 }
    }

    /// Takes a frame from the bus.
    pub fn receive(&mut self, frame: &CanFrame, now_us: u64, out: &mut Vec<CanFrame>) {
        self.node.receive(frame, now_us, out);
    }

    /// Publishes the channels.
    pub fn tick(&mut self, now_us: u64, channels: SafetyChannels, out: &mut Vec<CanFrame>) {
        self.node.tick(now_us, out);
        if self.node.operational() && now_us >= self.next_us {
            self.next_us = now_us + PERIOD_US;
            let [switches, floor] = channels.input_bytes();
            out.push(CanFrame::new(0x180 + u32::from(self.node.id), &[0, 0, 0, 0, switches, floor, 0, 0]));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_pressed_button_clears_both_bits() {
        let mut gateway = Gateway::new(5);
        let mut out = Vec::new();
        gateway.receive(&CanFrame::new(0, &[1, 0]), 0, &mut out);
        let pressed = SafetyChannels { emergency_stop: [false; 2], ..SafetyChannels::default() };
        gateway.tick(0, pressed, &mut out);
        assert_eq!(out.last(), Some(&CanFrame::new(0x185, &[0, 0, 0, 0, 0b11_1100, 0b11, 0, 0])));
    }
}
