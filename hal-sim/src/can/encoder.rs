//! A CiA 406 absolute encoder on a rear wheel (book, CANopen: CiA 406 encoders).

use super::{CanFrame, Node};

/// Counts after which the position starts over (6002h).
const RANGE_COUNTS: u32 = 1 << 24;

/// An encoder on the bus.
#[derive(Clone, Debug)]
pub struct Encoder {
    /// The bus side.
    pub node: Node,
}

impl Encoder {
    /// An encoder that has just been powered.
    #[must_use]
    pub fn new(id: u8) -> Self {
        let mut node = Node::new(id, 0x0002_0196);
        let objects = &mut node.objects;
        objects.define(0x6000, 0, 2, 0);
        objects.define(0x6001, 0, 4, 4_096);
        objects.define(0x6002, 0, 4, RANGE_COUNTS);
        objects.define_read_only(0x6004, 0, 4, 0);
        objects.define_read_only(0x6030, 0, 1, 1);
        objects.define_read_only(0x6030, 1, 2, 0);
        objects.define(0x6200, 0, 2, 0);
        objects.define_read_only(0x6503, 0, 2, 0);
        Self { node }
    }

    /// Takes a frame from the bus.
    pub fn receive(&mut self, frame: &CanFrame, now_us: u64, out: &mut Vec<CanFrame>) {
        self.node.receive(frame, now_us, out);
    }

    /// The wheel has turned to `counts`, at `counts_per_s`.
    pub fn tick(&mut self, now_us: u64, counts: i64, counts_per_s: f32, out: &mut Vec<CanFrame>) {
        let range = i64::from(self.node.objects.get(0x6002, 0).max(1));
        self.node.objects.set(0x6004, 0, counts.rem_euclid(range) as u32);
        // The speed unit of the AHM36's default scaling: counts per 10 ms fit its 16 bits at any speed of the robot.
        let speed = (counts_per_s * 0.01).round().clamp(-32_768.0, 32_767.0) as i16;
        self.node.objects.set(0x6030, 1, u32::from(speed as u16));
        self.node.tick(now_us, out);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn position_and_speed_as_in_the_example() {
        let mut encoder = Encoder::new(0x20);
        let mut out = Vec::new();
        for write in [
            [0x23, 0x02, 0x60, 0, 0, 0, 0, 0x40],
            [0x23, 0x00, 0x1A, 1, 0x20, 0, 0x04, 0x60],
            [0x23, 0x00, 0x1A, 2, 0x10, 1, 0x30, 0x60],
            [0x2F, 0x00, 0x1A, 0, 2, 0, 0, 0],
            [0x2F, 0x00, 0x18, 2, 1, 0, 0, 0],
            [0x23, 0x00, 0x18, 1, 0xA0, 1, 0, 0],
        ] {
            encoder.receive(&CanFrame::new(0x620, &write), 0, &mut out);
        }
        encoder.receive(&CanFrame::new(0, &[1, 0x20]), 0, &mut out);
        encoder.tick(0, 305_419_896, -10_000.0, &mut out);
        out.clear();
        encoder.receive(&CanFrame::new(0x80, &[]), 0, &mut out);
        assert_eq!(out, [CanFrame::new(0x1A0, &[0x78, 0x56, 0x34, 0x12, 0x9C, 0xFF])]);
    }

    /// Device type of the book, CANopen: CiA 406 encoders.
    #[test]
    fn device_type_equals_the_vector() {
        let mut encoder = Encoder::new(5);
        let mut out = Vec::new();
        encoder.receive(&CanFrame::new(0x605, &[0x40, 0, 0x10, 0, 0, 0, 0, 0]), 0, &mut out);
        assert_eq!(out, [CanFrame::new(0x585, &[0x43, 0, 0x10, 0, 0x96, 1, 2, 0])]);
    }
}
