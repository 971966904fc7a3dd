//! The configuration of a node before it may start: a list of SDO requests.

use floorguard_types::number::truncating_u32;

use heapless::Vec;

use super::sdo::SdoRequest;

/// Steps of the longest script (a drive: 25), and reserve.
pub const SCRIPT_STEPS_MAX: usize = 40;

/// One request; the answer to a read is kept for the caller.
pub type Step = SdoRequest;

/// Steps in order.
///
/// ```
/// use floorguard_drivers::canopen::Script;
///
/// // Statusword and velocity in the first process data object (number 0) of node 5, at every SYNC.
/// let script = Script::new().transmit(5, 0, (1, &[0x6041_0010, 0x606C_0020]));
/// assert_eq!((script.len(), script.overflowed()), (7, false));
/// let first = script.step(0).unwrap();
/// assert_eq!((first.index, first.subindex, first.write), (0x1800, 1, Some((0x8000_0185, 4))));
/// ```
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Script {
    steps: Vec<Step, SCRIPT_STEPS_MAX>,
    /// One bit for each step whose object a device need not have.
    optional: u64,
    overflowed: bool,
}

impl Script {
    /// No steps.
    #[must_use]
    pub const fn new() -> Self {
        Self { steps: Vec::new(), optional: 0, overflowed: false }
    }

    /// Adds a write to an object that a device need not have: that it is missing is no refusal.
    #[must_use]
    pub fn write_if_present(mut self, index: u16, subindex: u8, value: u32, bytes: u8) -> Self {
        self.optional |= bit(self.steps.len());
        self.write(index, subindex, value, bytes)
    }

    /// The object of a step may be missing.
    #[must_use]
    pub fn is_optional(&self, number: usize) -> bool {
        self.optional & bit(number) != 0
    }

    /// Adds a write of 1, 2 or 4 bytes.
    #[must_use]
    pub fn write(mut self, index: u16, subindex: u8, value: u32, bytes: u8) -> Self {
        self.overflowed |= self.steps.push(Step { index, subindex, write: Some((value, bytes)) }).is_err();
        self
    }

    /// Adds a read.
    #[must_use]
    pub fn read(mut self, index: u16, subindex: u8) -> Self {
        self.overflowed |= self.steps.push(Step { index, subindex, write: None }).is_err();
        self
    }

    /// Adds the steps of another one.
    #[must_use]
    pub fn followed_by(mut self, other: &Self) -> Self {
        self.optional |= other.optional.wrapping_shl(truncating_u32(self.steps.len()));
        self.overflowed |= other.overflowed || self.steps.extend_from_slice(&other.steps).is_err();
        self
    }

    /// Process data of the device: number 0…3, transmission type (1…240: every n-th SYNC, 255: by event), mapped
    /// objects as index, sub-index and bits packed in 32 bits. Switched off while it is written (book, CANopen: Process
    /// data).
    #[must_use]
    pub fn transmit(self, node: u8, pdo: u8, (kind, mapped): (u8, &[u32])) -> Self {
        let id = 0x180 + 0x100 * u32::from(pdo & 3) + u32::from(node & 0x7F);
        self.map((0x1800 | u16::from(pdo & 3), 0x1A00 | u16::from(pdo & 3)), id, (kind, mapped))
    }

    /// Process data to the device, see [`Self::transmit`].
    #[must_use]
    pub fn receive(self, node: u8, pdo: u8, (kind, mapped): (u8, &[u32])) -> Self {
        let id = 0x200 + 0x100 * u32::from(pdo & 3) + u32::from(node & 0x7F);
        self.map((0x1400 | u16::from(pdo & 3), 0x1600 | u16::from(pdo & 3)), id, (kind, mapped))
    }

    fn map(self, (communication, mapping): (u16, u16), id: u32, (kind, mapped): (u8, &[u32])) -> Self {
        let mut script = self.write(communication, 1, id | 0x8000_0000, 4).write(mapping, 0, 0, 1);
        let mut count = 0_u8;
        for object in mapped.iter().take(8) {
            count = count.saturating_add(1);
            script = script.write(mapping, count, *object, 4);
        }
        script.write(mapping, 0, u32::from(count), 1).write(communication, 2, u32::from(kind), 1).write(
            communication,
            1,
            id,
            4,
        )
    }

    /// A step.
    #[must_use]
    pub fn step(&self, number: usize) -> Option<&Step> {
        self.steps.get(number)
    }

    /// Steps in it.
    #[must_use]
    pub fn len(&self) -> usize {
        self.steps.len()
    }

    /// Nothing to do.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.steps.is_empty()
    }

    /// More steps were added than fit: a mistake in the program that a test of each script rules out.
    #[must_use]
    pub const fn overflowed(&self) -> bool {
        self.overflowed
    }
}

const _: () = assert!(SCRIPT_STEPS_MAX <= 64);

fn bit(number: usize) -> u64 {
    1_u64.wrapping_shl(truncating_u32(number))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::can::CanFrame;
    use std::vec::Vec;

    /// The frames of the book, CANopen: Process data for node 5, TPDO1.
    #[test]
    fn published_mapping() {
        let script =
            Script::new().transmit(5, 0, (1, &[0x6041_0010, 0x606C_0020])).write(0x1016, 1, 0x007F_00C8, 4);
        let expected: [[u8; 8]; 8] = [
            [0x23, 0x00, 0x18, 0x01, 0x85, 0x01, 0x00, 0x80],
            [0x2F, 0x00, 0x1A, 0x00, 0x00, 0x00, 0x00, 0x00],
            [0x23, 0x00, 0x1A, 0x01, 0x10, 0x00, 0x41, 0x60],
            [0x23, 0x00, 0x1A, 0x02, 0x20, 0x00, 0x6C, 0x60],
            [0x2F, 0x00, 0x1A, 0x00, 0x02, 0x00, 0x00, 0x00],
            [0x2F, 0x00, 0x18, 0x02, 0x01, 0x00, 0x00, 0x00],
            [0x23, 0x00, 0x18, 0x01, 0x85, 0x01, 0x00, 0x00],
            [0x23, 0x16, 0x10, 0x01, 0xC8, 0x00, 0x7F, 0x00],
        ];
        assert_eq!(script.len(), expected.len());
        for (number, payload) in expected.iter().enumerate() {
            assert_eq!(script.step(number).unwrap().frame(5), CanFrame::standard(0x605, payload));
        }
    }

    fn writes(script: &Script) -> Vec<(u16, u8, u32, u8)> {
        let steps = (0..script.len()).filter_map(|number| script.step(number));
        steps.map(|step| (step.index, step.subindex, step.write.unwrap().0, step.write.unwrap().1)).collect()
    }

    /// The predefined connection set of CiA 301: 180h, 280h … from the device, 200h, 300h … to it.
    #[test]
    fn each_number_has_its_identifier_and_its_objects() {
        for (pdo, tx, rx) in [(0, 0x180, 0x200), (1, 0x280, 0x300), (2, 0x380, 0x400), (3, 0x480, 0x500)] {
            for node in [1, 0x45, 0x7F] {
                let from = writes(&Script::new().transmit(node, pdo, (255, &[])));
                let to = writes(&Script::new().receive(node, pdo, (255, &[])));
                let number = u16::from(pdo);
                let on = |objects: &[(u16, u8, u32, u8)]| *objects.last().unwrap();
                assert_eq!(on(&from), (0x1800 + number, 1, tx + u32::from(node), 4));
                assert_eq!(on(&to), (0x1400 + number, 1, rx + u32::from(node), 4));
                assert_eq!((from[1].0, to[1].0), (0x1A00 + number, 0x1600 + number));
            }
        }
        let beyond = writes(&Script::new().receive(0xFF, 7, (255, &[])));
        assert_eq!(beyond.last(), Some(&(0x1403, 1, 0x57F, 4)), "cut to what there is");
    }

    #[test]
    fn overflow_of_the_script_is_reported() {
        let mut script = Script::new();
        assert!(script.is_empty());
        for step in 0..SCRIPT_STEPS_MAX {
            assert!(!script.overflowed(), "{step}");
            script = if step % 2 == 0 { script.read(0x1000, 0) } else { script.write(0x1017, 0, 100, 2) };
        }
        assert!(!script.overflowed() && !script.is_empty());
        assert!(script.clone().read(0x1000, 0).overflowed());
        let over = script.clone().write(0x1017, 0, 100, 2);
        assert!(over.overflowed());
        assert!(over.clone().read(0x1000, 0).overflowed() && over.clone().write(0, 0, 0, 1).overflowed());
        let one = Script::new().read(0x1000, 0);
        assert!(script.followed_by(&one).overflowed(), "full");
        assert!(one.clone().followed_by(&over).overflowed(), "incomplete already");
        let both = one.clone().followed_by(&one);
        assert_eq!((both.len(), both.overflowed()), (2, false));
        assert!(over.followed_by(&Script::new()).overflowed(), "once reported, always reported");
    }
}
