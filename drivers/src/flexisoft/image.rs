//! From the controller's process image to safety inputs, by a configured map of bits.
//!
//! A dead module, a missing byte and an object that is not sent any more read as `Unknown`, which is danger; with
//! channels of which 1 is the operating state, so does a cut wire.

use floorguard_types::sensing::{DiscreteInputs, SafetyInput};
use floorguard_types::time::{Age, Stamp};

use super::map::{IMAGE_OBJECTS, InputBits, InputMap};
use crate::discrete_inputs::DualChannel;

/// An object that was not sent for this long is not known any more, microseconds (book, Safety inputs: Flexi Soft
/// gateway).
const OBJECT_AGE_US: u64 = 100_000;

/// One process data object as it arrived last.
#[derive(Clone, Copy, Debug)]
struct Object {
    stamp: Stamp,
    bytes: [u8; 8],
    length: usize,
}

/// Judges each image.
///
/// ```
/// use floorguard_drivers::flexisoft::{InputBits, InputMap, SafetyImage};
/// use floorguard_types::sensing::SafetyInput;
/// use floorguard_types::time::Stamp;
///
/// let map = InputMap {
///     emergency_stop: InputBits::new([32, 33]),
///     bumper_front: InputBits::complementary([34, 35]),
///     discrepancy_us: 100_000,
///     ..InputMap::default()
/// };
/// let mut image = SafetyImage::new(map);
/// let inputs = image.take(0, &[0, 0, 0, 0, 0b0101, 0, 0, 0], Stamp::ZERO).unwrap();
/// assert_eq!(inputs.emergency_stop, SafetyInput::Active);
/// assert_eq!(inputs.bumper_front, SafetyInput::Clear);
/// ```
#[derive(Clone, Copy, Debug)]
pub struct SafetyImage {
    pub(crate) map: InputMap,
    objects: [Option<Object>; IMAGE_OBJECTS],
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
            objects: [None; IMAGE_OBJECTS],
            emergency_stop: channel,
            bumper_front: channel,
            bumper_rear: channel,
            cliff_front: channel,
            cliff_rear: channel,
        }
    }

    /// It reads the image by this map.
    #[must_use]
    pub fn is_of(&self, map: &InputMap) -> bool {
        let channels = [
            &self.emergency_stop,
            &self.bumper_front,
            &self.bumper_rear,
            &self.cliff_front,
            &self.cliff_rear,
        ];
        self.map == *map && channels.iter().all(|channel| channel.discrepancy_us() == map.discrepancy_us)
    }

    /// Takes in a process data object, 0…3, that arrived now. The inputs, once each object in which one stands has
    /// arrived; `None` before, and for an object without any.
    pub fn take(&mut self, object: usize, payload: &[u8], now: Stamp) -> Option<DiscreteInputs> {
        let mut taken = Object { stamp: now, bytes: [0; 8], length: payload.len().min(8) };
        for (cell, byte) in taken.bytes.iter_mut().zip(payload) {
            *cell = *byte;
        }
        *self.objects.get_mut(object)? = Some(taken);
        let missing = |(number, object): (usize, &Option<Object>)| object.is_none() && self.map.uses(number);
        let complete = !self.objects.iter().enumerate().any(missing);
        (complete && self.map.uses(object)).then(|| self.judge(now))
    }

    fn judge(&mut self, now: Stamp) -> DiscreteInputs {
        let objects = self.objects;
        let read = |input: InputBits, channel: &mut DualChannel| judge_input(&objects, input, channel, now);
        let fitted = |input: Option<InputBits>, channel: &mut DualChannel| {
            input.map_or(SafetyInput::Clear, |input| read(input, channel))
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

/// One input. A channel out of its operating state is danger whatever became of the other one.
fn judge_input(
    objects: &[Option<Object>; IMAGE_OBJECTS],
    input: InputBits,
    channel: &mut DualChannel,
    now: Stamp,
) -> SafetyInput {
    let [first, second] = input.bits;
    let [first_inverted, second_inverted] = input.inverted;
    let operating = |bit, inverted| is_set(objects, bit, now).map(|set| set != inverted);
    match (operating(first, first_inverted), operating(second, second_inverted)) {
        (Some(a), Some(b)) => channel.judge([a, b], now),
        (Some(false), None) | (None, Some(false)) => SafetyInput::Active,
        _ => SafetyInput::Unknown,
    }
}

/// `None` for a bit that was not sent, or not lately.
fn is_set(objects: &[Option<Object>; IMAGE_OBJECTS], bit: u8, now: Stamp) -> Option<bool> {
    let object = objects.get(usize::from(bit / 64)).copied().flatten()?;
    let fresh = matches!(object.stamp.age(now), Age::Past(us) if us <= OBJECT_AGE_US);
    let byte = object.bytes.get(..object.length)?.get(usize::from(bit % 64 / 8)).filter(|_| fresh)?;
    Some(byte & (1 << (bit % 8)) != 0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use SafetyInput::{Active, Clear, Fault, Unknown};
    use proptest::prelude::*;

    const MAP: InputMap = InputMap {
        emergency_stop: InputBits::new([32, 33]),
        bumper_front: InputBits::new([34, 35]),
        bumper_rear: Some(InputBits::new([36, 37])),
        cliff_front: Some(InputBits::new([40, 40])),
        cliff_rear: None,
        discrepancy_us: 100_000,
    };

    fn at(ms: u64) -> Stamp {
        Stamp::from_micros(ms * 1_000)
    }

    #[test]
    fn every_bit_means_what_the_map_says() {
        let mut image = SafetyImage::new(MAP);
        let clear = image.take(0, &[0, 0, 0, 0, 0b11_1111, 1, 0, 0], at(5)).unwrap();
        assert_eq!(clear, DiscreteInputs::all_clear(at(5)));
        let pressed = image.take(0, &[0, 0, 0, 0, 0b11_1101, 1, 0, 0], at(5)).unwrap();
        assert_eq!(pressed.emergency_stop, Active);
        assert_eq!(pressed.bumper_front, Clear);
        let edge = image.take(0, &[0, 0, 0, 0, 0b11_1111, 0, 0, 0], at(5)).unwrap();
        assert_eq!((edge.cliff_front, edge.cliff_rear), (Active, Clear));
    }

    #[test]
    fn unsent_inputs_are_unknown_sent_ones_known() {
        let inputs = SafetyImage::new(MAP).take(0, &[0xFF; 4], at(0)).unwrap();
        assert_eq!((inputs.emergency_stop, inputs.cliff_front), (Unknown, Unknown));
        let split = InputMap { emergency_stop: InputBits::new([31, 33]), ..MAP };
        let pressed = SafetyImage::new(split).take(0, &[0xFF, 0xFF, 0xFF, 0x7F], at(0)).unwrap();
        assert_eq!(pressed.emergency_stop, Active);
    }

    /// The factory mapping puts the inputs of modules 5 to 12 into the second object (book, Safety inputs: Flexi Soft
    /// gateway).
    #[test]
    fn split_inputs_need_all_objects() {
        let map = InputMap { bumper_front: InputBits::new([64 + 8, 64 + 9]), ..MAP };
        let mut image = SafetyImage::new(map);
        let first = [0, 0, 0, 0, 0b11_0011, 1, 0, 0];
        assert_eq!(image.take(0, &first, at(0)), None, "the second has not arrived yet");
        assert_eq!(image.take(3, &[0xFF; 8], at(0)), None, "nothing stands in the fourth");
        assert_eq!(image.take(4, &[0xFF; 8], at(0)), None, "there is no fifth");
        assert_eq!(image.take(1, &[0, 3], at(10)), Some(DiscreteInputs::all_clear(at(10))));
        assert_eq!(image.take(0, &first, at(110)).unwrap().bumper_front, Clear);
        assert_eq!(image.take(0, &first, at(111)).unwrap().bumper_front, Unknown, "silent for too long");
        assert_eq!(image.take(1, &[0, 1], at(112)).unwrap().bumper_front, Active);
    }

    /// The table of the book, Safety inputs: Two channels.
    #[test]
    fn complementary_channels() {
        let map = InputMap { emergency_stop: InputBits::complementary([0, 1]), ..MAP };
        let judged = |steps: &[(u64, u8)]| {
            let mut image = SafetyImage::new(map);
            let judge = |(ms, bits): &(u64, u8)| {
                image.take(0, &[*bits, 0, 0, 0, 0xFF, 0xFF], at(*ms)).unwrap().emergency_stop
            };
            steps.iter().map(judge).collect::<std::vec::Vec<_>>()
        };
        assert_eq!(judged(&[(0, 0b01), (10, 0b10), (20, 0b01)]), [Clear, Active, Clear]);
        for equal in [0b00, 0b11] {
            let steps = [(0, equal), (101, equal), (110, 0b01), (120, 0b10), (130, 0b01)];
            assert_eq!(judged(&steps), [Active, Fault, Fault, Active, Clear], "{equal:02b}");
        }
    }

    proptest! {
        /// Nothing is clear whose channels were not both just seen in their operating state.
        #[test]
        fn clear_is_only_what_was_seen(
            bits: [u8; 2], inverted: [bool; 2], steps in proptest::collection::vec(
                (0_usize..6, proptest::collection::vec(any::<u8>(), 0..=8), 0_u64..80), 1..40),
        ) {
            let map = InputMap { emergency_stop: InputBits { bits, inverted }, ..InputMap::default() };
            let mut image = SafetyImage::new(map);
            let mut seen: [Option<(u64, std::vec::Vec<u8>)>; 4] = Default::default();
            let mut now_ms = 0;
            for (object, payload, step_ms) in steps {
                now_ms += step_ms;
                let inputs = image.take(object, &payload, at(now_ms));
                if let Some(slot) = seen.get_mut(object) {
                    *slot = Some((now_ms, payload));
                }
                if inputs.is_some_and(|inputs| inputs.emergency_stop == Clear) {
                    for (bit, inverted) in bits.into_iter().zip(inverted) {
                        let (sent_ms, payload) = seen[usize::from(bit) / 64].clone().unwrap();
                        prop_assert!(now_ms - sent_ms <= 100);
                        let byte = payload[usize::from(bit) % 64 / 8];
                        prop_assert_eq!(byte >> (bit % 8) & 1 == 1, !inverted);
                    }
                }
            }
        }
    }
}
