//! From the controller's process image to safety inputs, by a configured map of bits.
//!
//! The Flexi Soft project decides what each bit means, so nothing is assumed. 1 is the operating state: a cut wire, a
//! dead module and a missing byte read as danger.

use floorguard_core::sensing::{DiscreteInputs, SafetyInput};
use floorguard_core::time::Stamp;

use crate::discrete_inputs::DualChannel;

/// The two channels of one input: numbers of bits in the first process data object, 0 is the lowest bit of byte 0.
/// Both are the same for an input with a single channel.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct InputBits(pub [u8; 2]);

/// What the image means. `None`: the robot has no such input.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct InputMap {
    /// Emergency stop.
    pub emergency_stop: InputBits,
    /// Contact edge at the front.
    pub bumper_front: InputBits,
    /// Contact edge at the rear.
    pub bumper_rear: Option<InputBits>,
    /// Floor sensors at the front.
    pub cliff_front: Option<InputBits>,
    /// Floor sensors at the rear.
    pub cliff_rear: Option<InputBits>,
    /// The channels of an input may differ for this long, microseconds.
    pub discrepancy_us: u64,
}

/// Judges each image.
#[derive(Clone, Copy, Debug)]
pub struct SafetyImage {
    map: InputMap,
    emergency_stop: DualChannel,
    bumper_front: DualChannel,
    bumper_rear: DualChannel,
    cliff_front: DualChannel,
    cliff_rear: DualChannel,
}

impl SafetyImage {
    /// For a map.
    #[must_use]
    pub const fn new(map: InputMap) -> Self {
        let channel = DualChannel::new(map.discrepancy_us);
        Self {
            map,
            emergency_stop: channel,
            bumper_front: channel,
            bumper_rear: channel,
            cliff_front: channel,
            cliff_rear: channel,
        }
    }

    /// The inputs in a process data object that arrived now.
    pub fn judge(&mut self, payload: &[u8], now: Stamp) -> DiscreteInputs {
        let read = |bits: InputBits, channel: &mut DualChannel| {
            channel.judge(bits.0.map(|bit| is_set(payload, bit)), now)
        };
        let fitted = |bits: Option<InputBits>, channel: &mut DualChannel| {
            bits.map_or(SafetyInput::Clear, |bits| read(bits, channel))
        };
        DiscreteInputs {
            stamp: now,
            emergency_stop: read(self.map.emergency_stop, &mut self.emergency_stop),
            bumper_front: read(self.map.bumper_front, &mut self.bumper_front),
            bumper_rear: fitted(self.map.bumper_rear, &mut self.bumper_rear),
            cliff_front: fitted(self.map.cliff_front, &mut self.cliff_front),
            cliff_rear: fitted(self.map.cliff_rear, &mut self.cliff_rear),
        }
    }
}

/// A bit that was not sent is not set.
fn is_set(payload: &[u8], bit: u8) -> bool {
    payload.get(usize::from(bit / 8)).is_some_and(|byte| byte & (1 << (bit % 8)) != 0)
}

#[cfg(test)]
mod tests {
    use super::*;

    const MAP: InputMap = InputMap {
        emergency_stop: InputBits([32, 33]),
        bumper_front: InputBits([34, 35]),
        bumper_rear: Some(InputBits([36, 37])),
        cliff_front: Some(InputBits([40, 40])),
        cliff_rear: None,
        discrepancy_us: 100_000,
    };

    #[test]
    fn every_bit_means_what_the_map_says() {
        let mut image = SafetyImage::new(MAP);
        let now = Stamp::from_micros(5);
        let clear = image.judge(&[0, 0, 0, 0, 0b11_1111, 1, 0, 0], now);
        assert_eq!(clear, DiscreteInputs::all_clear(now));
        let pressed = image.judge(&[0, 0, 0, 0, 0b11_1101, 1, 0, 0], now);
        assert_eq!(pressed.emergency_stop, SafetyInput::Active);
        assert_eq!(pressed.bumper_front, SafetyInput::Clear);
        let edge = image.judge(&[0, 0, 0, 0, 0b11_1111, 0, 0, 0], now);
        assert_eq!((edge.cliff_front, edge.cliff_rear), (SafetyInput::Active, SafetyInput::Clear));
    }

    #[test]
    fn a_short_image_is_danger() {
        let inputs = SafetyImage::new(MAP).judge(&[0xFF; 4], Stamp::ZERO);
        assert_eq!(inputs.emergency_stop, SafetyInput::Active);
        assert_eq!(inputs.cliff_front, SafetyInput::Active);
    }
}
