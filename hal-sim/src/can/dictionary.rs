//! The object dictionary of a device and its SDO server (book, CANopen: SDO).

use std::collections::BTreeMap;

/// No such object.
const ABORT_NO_OBJECT: u32 = 0x0602_0000;
/// Written although read-only.
const ABORT_READ_ONLY: u32 = 0x0601_0002;
/// Length does not fit.
const ABORT_LENGTH: u32 = 0x0607_0010;
/// Unknown command.
const ABORT_COMMAND: u32 = 0x0504_0001;

#[derive(Clone, Copy, Debug)]
struct Entry {
    bytes: u8,
    writable: bool,
    value: u32,
}

/// Objects of up to four bytes by index and sub-index.
#[derive(Clone, Debug, Default)]
pub struct Dictionary {
    entries: BTreeMap<(u16, u8), Entry>,
}

impl Dictionary {
    /// Adds or replaces an object of 1, 2 or 4 bytes.
    pub fn define(&mut self, index: u16, sub: u8, bytes: u8, value: u32) {
        self.entries.insert((index, sub), Entry { bytes, writable: true, value });
    }

    /// As [`Self::define`], refused to SDO writers.
    pub fn define_read_only(&mut self, index: u16, sub: u8, bytes: u8, value: u32) {
        self.entries.insert((index, sub), Entry { bytes, writable: false, value });
    }

    /// The value; 0 where there is no object.
    #[must_use]
    pub fn get(&self, index: u16, sub: u8) -> u32 {
        self.entries.get(&(index, sub)).map_or(0, |entry| entry.value)
    }

    /// Sets an existing object from inside the device.
    pub fn set(&mut self, index: u16, sub: u8, value: u32) {
        if let Some(entry) = self.entries.get_mut(&(index, sub)) {
            entry.value = value;
        }
    }

    /// Answers an SDO request of eight bytes; true when a value was written.
    pub fn serve(&mut self, request: &[u8; 8]) -> ([u8; 8], bool) {
        let index = u16::from_le_bytes([request[1], request[2]]);
        let sub = request[3];
        let mut answer = [0, request[1], request[2], request[3], 0, 0, 0, 0];
        let outcome = match request[0] {
            0x40 => self.read(index, sub).map(|(command, value)| (command, value, false)),
            0x20 | 0x22 => self.write(index, sub, None, request).map(|()| (0x60, 0, true)),
            command @ (0x2F | 0x2B | 0x27 | 0x23) => {
                let bytes = 4 - ((command >> 2) & 3);
                self.write(index, sub, Some(bytes), request).map(|()| (0x60, 0, true))
            }
            _ => Err(ABORT_COMMAND),
        };
        let (command, value, written) = outcome.unwrap_or_else(|abort| (0x80, abort, false));
        answer[0] = command;
        answer[4..].copy_from_slice(&value.to_le_bytes());
        (answer, written)
    }

    fn read(&self, index: u16, sub: u8) -> Result<(u8, u32), u32> {
        let entry = self.entries.get(&(index, sub)).ok_or(ABORT_NO_OBJECT)?;
        let mask = if entry.bytes >= 4 { u32::MAX } else { (1 << (8 * entry.bytes)) - 1 };
        Ok((0x43 | ((4 - entry.bytes) << 2), entry.value & mask))
    }

    fn write(&mut self, index: u16, sub: u8, bytes: Option<u8>, request: &[u8; 8]) -> Result<(), u32> {
        let entry = self.entries.get_mut(&(index, sub)).ok_or(ABORT_NO_OBJECT)?;
        if !entry.writable {
            return Err(ABORT_READ_ONLY);
        }
        if bytes.is_some_and(|bytes| bytes != entry.bytes) {
            return Err(ABORT_LENGTH);
        }
        let raw = [request[4], request[5], request[6], request[7]];
        let mut kept = [0; 4];
        for (cell, byte) in kept.iter_mut().zip(raw.iter().take(usize::from(entry.bytes))) {
            *cell = *byte;
        }
        entry.value = u32::from_le_bytes(kept);
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The transfers of the book, CANopen: SDO.
    #[test]
    fn transfers_equal_the_vectors() {
        let mut objects = Dictionary::default();
        objects.define_read_only(0x1000, 0, 4, 0x0002_0192);
        objects.define(0x6060, 0, 1, 0);
        objects.define_read_only(0x6041, 0, 2, 0);
        objects.define_read_only(0x6061, 0, 1, 3);
        let mut ask = |request: [u8; 8]| objects.serve(&request).0;
        assert_eq!(ask([0x40, 0, 0x10, 0, 0, 0, 0, 0]), [0x43, 0, 0x10, 0, 0x92, 1, 2, 0]);
        assert_eq!(ask([0x2F, 0x60, 0x60, 0, 3, 0, 0, 0]), [0x60, 0x60, 0x60, 0, 0, 0, 0, 0]);
        assert_eq!(ask([0x40, 0x61, 0x60, 0, 0, 0, 0, 0]), [0x4F, 0x61, 0x60, 0, 3, 0, 0, 0]);
        assert_eq!(ask([0x40, 0x55, 0x55, 0, 0, 0, 0, 0]), [0x80, 0x55, 0x55, 0, 0, 0, 2, 6]);
        assert_eq!(ask([0x2B, 0x41, 0x60, 0, 0, 0, 0, 0]), [0x80, 0x41, 0x60, 0, 2, 0, 1, 6]);
        assert_eq!(ask([0x23, 0x60, 0x60, 0, 1, 2, 3, 4]), [0x80, 0x60, 0x60, 0, 0x10, 0, 7, 6]);
    }
}
