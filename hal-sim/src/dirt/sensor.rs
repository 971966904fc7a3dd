//! The dirt sensor under the robot, a node on the CAN bus: it counts what the brush throws against its plate.
//!
//! Its one message is its own convention, as these sensors have no standard: identifier 180h + node, four bytes, every
//! 50 ms without being asked: the count so far (16 bits, little-endian, wraps), flags (bit 0: the brush is down and turns),
//! and a counter of the messages. A count that goes on makes a lost message harmless.

use floorguard_types::random::Pcg32;

use crate::can::CanFrame;

/// From message to message, microseconds.
const PERIOD_US: u64 = 50_000;
/// Bit of the flags: the brush is down and turns.
const BRUSH_TURNS: u8 = 1;
/// A unit of dirt that goes by unheard.
const MISSED: f32 = 0.02;
/// Hits without dirt, a second.
const FALSE_PER_S: f32 = 0.1;

/// The sensor.
#[derive(Clone, Debug)]
pub struct DirtSensor {
    node: u8,
    count: u16,
    sent: u8,
    next_us: u64,
    random: Pcg32,
}

impl DirtSensor {
    /// A sensor that has just been powered.
    #[must_use]
    pub fn new(node: u8, seed: u64) -> Self {
        Self { node, count: 0, sent: 0, next_us: PERIOD_US, random: Pcg32::new(seed, 61) }
    }

    /// The brush picked this up within `lasts_s`.
    pub fn hear(&mut self, units: u32, lasts_s: f32) {
        let heard = (0..units).filter(|_| !self.random.bernoulli(MISSED)).count() as u32;
        let hits = heard + self.random.poisson(FALSE_PER_S * lasts_s);
        self.count = self.count.wrapping_add(hits as u16);
    }

    /// The message that is due.
    pub fn tick(&mut self, now_us: u64) -> Option<CanFrame> {
        if now_us < self.next_us {
            return None;
        }
        self.next_us += PERIOD_US;
        self.sent = self.sent.wrapping_add(1);
        let [low, high] = self.count.to_le_bytes();
        Some(CanFrame::new(0x180 + u32::from(self.node), &[low, high, BRUSH_TURNS, self.sent]))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn count_has_few_misses_and_false_hits() {
        let mut sensor = DirtSensor::new(6, 1);
        for _ in 0..1_000 {
            sensor.hear(10, 0.01);
        }
        assert!((9_700..9_950).contains(&sensor.count), "{}", sensor.count);
        let before = sensor.count;
        for _ in 0..10_000 {
            sensor.hear(0, 0.01);
        }
        assert!((2..25).contains(&(sensor.count - before)), "{}", sensor.count - before);
        assert_eq!(sensor.tick(49_999), None);
        let [low, high] = sensor.count.to_le_bytes();
        assert_eq!(sensor.tick(50_000), Some(CanFrame::new(0x186, &[low, high, 1, 1])));
        assert_eq!(sensor.tick(50_001), None);
    }
}
