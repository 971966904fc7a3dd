//! Expedited SDO: read or write one object of up to four bytes (book, CANopen: SDO).

use core::fmt;

use crate::can::CanFrame;

/// One request of the master.
///
/// ```
/// use floorguard_drivers::can::CanFrame;
/// use floorguard_drivers::canopen::SdoRequest;
///
/// // Target velocity −1000 to node 5.
/// let request = SdoRequest { index: 0x60FF, subindex: 0, write: Some(((-1_000_i32) as u32, 4)) };
/// let wanted = CanFrame::standard(0x605, &[0x23, 0xFF, 0x60, 0x00, 0x18, 0xFC, 0xFF, 0xFF]);
/// assert_eq!(request.frame(5), wanted);
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct SdoRequest {
    /// Object.
    pub index: u16,
    /// Part of it.
    pub subindex: u8,
    /// `None` reads; otherwise the value, little-endian in the lowest bytes, and its size in bytes, 1, 2 or 4.
    pub write: Option<(u32, u8)>,
}

/// What a node answered.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SdoAnswer {
    /// The write was done.
    Written,
    /// The value read, zero-extended.
    Value(u32),
    /// The object is longer than four bytes: its size.
    Segmented(u32),
    /// The node refused.
    Aborted(SdoError),
}

/// Why a node refused.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct SdoError(pub u32);

impl SdoError {
    /// No answer.
    pub const TIME_OUT: Self = Self(0x0504_0000);
    /// The object is longer than the request can take.
    pub const TOO_LONG: Self = Self(0x0607_0012);

    /// The device does not have the object, or this part of it.
    #[must_use]
    pub const fn is_missing_object(self) -> bool {
        matches!(self.0, 0x0602_0000 | 0x0609_0011)
    }
}

impl fmt::Display for SdoError {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        let what = match self.0 {
            0x0503_0000 => "toggle bit wrong",
            0x0504_0000 => "time-out",
            0x0504_0001 => "command unknown",
            0x0601_0000 => "access not supported",
            0x0601_0001 => "write-only object",
            0x0601_0002 => "read-only object",
            0x0602_0000 => "no such object",
            0x0604_0041 => "object cannot be mapped",
            0x0604_0042 => "process data too long",
            0x0604_0043 => "parameter incompatible",
            0x0604_0047 => "device incompatible",
            0x0606_0000 => "hardware error",
            0x0607_0010 => "wrong length",
            0x0607_0012 => "too long",
            0x0607_0013 => "too short",
            0x0609_0011 => "no such sub-index",
            0x0609_0030 => "value out of range",
            0x0800_0000 => "general error",
            0x0800_0020 => "cannot be stored",
            0x0800_0022 => "not in this state",
            _ => "unknown reason",
        };
        write!(out, "{what} ({:08X}h)", self.0)
    }
}

impl SdoRequest {
    /// The frame to a node.
    #[must_use]
    pub fn frame(&self, node: u8) -> CanFrame {
        let [low, high] = self.index.to_le_bytes();
        let (command, value) = match self.write {
            None => (0x40, 0),
            Some((value, 1)) => (0x2F, value & 0xFF),
            Some((value, 2)) => (0x2B, value & 0xFFFF),
            Some((value, _)) => (0x23, value),
        };
        let [a, b, c, d] = value.to_le_bytes();
        CanFrame::standard(0x600 | u16::from(node & 0x7F), &[command, low, high, self.subindex, a, b, c, d])
    }

    /// Whether an answer belongs to this request: a late one to another object must be discarded.
    #[must_use]
    pub const fn is_answered_by(&self, index: u16, subindex: u8) -> bool {
        self.index == index && self.subindex == subindex
    }
}

/// Decodes the payload of an answer: object, part, answer. Short frames are legal as long as the data are there.
///
/// ```
/// use floorguard_drivers::canopen::{SdoAnswer, SdoError, decode_sdo};
///
/// // The device type of a servo drive, and a refusal: there is no such object.
/// let answer = decode_sdo(&[0x43, 0x00, 0x10, 0x00, 0x92, 0x01, 0x02, 0x00]);
/// assert_eq!(answer, Some((0x1000, 0, SdoAnswer::Value(0x0002_0192))));
/// let refusal = decode_sdo(&[0x80, 0x55, 0x55, 0x00, 0x00, 0x00, 0x02, 0x06]);
/// assert_eq!(refusal, Some((0x5555, 0, SdoAnswer::Aborted(SdoError(0x0602_0000)))));
/// ```
#[must_use]
pub fn decode_sdo(payload: &[u8]) -> Option<(u16, u8, SdoAnswer)> {
    let (&[command, low, high, subindex], data) = payload.split_first_chunk::<4>()?;
    let index = u16::from_le_bytes([low, high]);
    let value = |bytes: usize| -> Option<u32> {
        let mut word = [0; 4];
        for (cell, byte) in word.iter_mut().zip(data.get(..bytes)?) {
            *cell = *byte;
        }
        Some(u32::from_le_bytes(word))
    };
    let answer = match command {
        0x60 => SdoAnswer::Written,
        0x80 => SdoAnswer::Aborted(SdoError(value(4)?)),
        0x4F => SdoAnswer::Value(value(1)?),
        0x4B => SdoAnswer::Value(value(2)?),
        0x47 => SdoAnswer::Value(value(3)?),
        0x43 => SdoAnswer::Value(value(4)?),
        // Size not given: what is there.
        0x42 => SdoAnswer::Value(value(data.len().min(4))?),
        0x41 => SdoAnswer::Segmented(value(4)?),
        _ => return None,
    };
    Some((index, subindex, answer))
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    const fn write(index: u16, value: i32, bytes: u8) -> SdoRequest {
        SdoRequest { index, subindex: 0, write: Some((value as u32, bytes)) }
    }

    const fn read(index: u16) -> SdoRequest {
        SdoRequest { index, subindex: 0, write: None }
    }

    /// Captured between two instances of an independent stack, node 5.
    const VECTORS: [(SdoRequest, [u8; 8], [u8; 8], SdoAnswer); 10] = [
        (
            read(0x1000),
            [0x40, 0, 0x10, 0, 0, 0, 0, 0],
            [0x43, 0, 0x10, 0, 0x92, 1, 2, 0],
            SdoAnswer::Value(0x0002_0192),
        ),
        (
            write(0x6060, 3, 1),
            [0x2F, 0x60, 0x60, 0, 3, 0, 0, 0],
            [0x60, 0x60, 0x60, 0, 0, 0, 0, 0],
            SdoAnswer::Written,
        ),
        (
            write(0x60FF, -1000, 4),
            [0x23, 0xFF, 0x60, 0, 0x18, 0xFC, 0xFF, 0xFF],
            [0x60, 0xFF, 0x60, 0, 0, 0, 0, 0],
            SdoAnswer::Written,
        ),
        (
            write(0x1017, 100, 2),
            [0x2B, 0x17, 0x10, 0, 0x64, 0, 0, 0],
            [0x60, 0x17, 0x10, 0, 0, 0, 0, 0],
            SdoAnswer::Written,
        ),
        (
            write(0x6040, 0x0F, 2),
            [0x2B, 0x40, 0x60, 0, 0x0F, 0, 0, 0],
            [0x60, 0x40, 0x60, 0, 0, 0, 0, 0],
            SdoAnswer::Written,
        ),
        (
            read(0x606C),
            [0x40, 0x6C, 0x60, 0, 0, 0, 0, 0],
            [0x43, 0x6C, 0x60, 0, 0x2E, 0xFB, 0xFF, 0xFF],
            SdoAnswer::Value(-1234_i32 as u32),
        ),
        (
            read(0x6061),
            [0x40, 0x61, 0x60, 0, 0, 0, 0, 0],
            [0x4F, 0x61, 0x60, 0, 3, 0, 0, 0],
            SdoAnswer::Value(3),
        ),
        (
            read(0x5555),
            [0x40, 0x55, 0x55, 0, 0, 0, 0, 0],
            [0x80, 0x55, 0x55, 0, 0, 0, 2, 6],
            SdoAnswer::Aborted(SdoError(0x0602_0000)),
        ),
        (
            write(0x6041, 0, 2),
            [0x2B, 0x41, 0x60, 0, 0, 0, 0, 0],
            [0x80, 0x41, 0x60, 0, 2, 0, 1, 6],
            SdoAnswer::Aborted(SdoError(0x0601_0002)),
        ),
        (
            write(0x6060, 0x0403_0201, 4),
            [0x23, 0x60, 0x60, 0, 1, 2, 3, 4],
            [0x80, 0x60, 0x60, 0, 0x10, 0, 7, 6],
            SdoAnswer::Aborted(SdoError(0x0607_0010)),
        ),
    ];

    #[test]
    fn captured_vectors() {
        for (request, sent, received, answer) in VECTORS {
            assert_eq!(request.frame(5), CanFrame::standard(0x605, &sent));
            let (index, subindex, decoded) = decode_sdo(&received).unwrap();
            assert!(request.is_answered_by(index, subindex));
            assert_eq!(decoded, answer);
        }
        assert_eq!(
            decode_sdo(&[0x41, 8, 0x10, 0, 0x0E, 0, 0, 0]),
            Some((0x1008, 0, SdoAnswer::Segmented(14)))
        );
    }

    /// Short and size-less answers of published documents.
    #[test]
    fn legal_oddities() {
        assert_eq!(decode_sdo(&[0x4F, 0, 0x14, 2, 0xFE]), Some((0x1400, 2, SdoAnswer::Value(0xFE))));
        assert_eq!(decode_sdo(&[0x4B, 0, 0x14, 2, 1, 2, 9, 9]), Some((0x1400, 2, SdoAnswer::Value(0x0201))));
        assert_eq!(
            decode_sdo(&[0x47, 0, 0x14, 2, 1, 2, 3, 9]),
            Some((0x1400, 2, SdoAnswer::Value(0x03_0201)))
        );
        assert_eq!(decode_sdo(&[0x42, 0, 0x14, 2, 0xFE, 0, 0, 0]), Some((0x1400, 2, SdoAnswer::Value(0xFE))));
        assert_eq!(decode_sdo(&[0x43, 0, 0x14, 2, 0xFE]), None);
        let identity = SdoRequest { index: 0x1018, subindex: 1, write: None };
        assert_eq!(identity.frame(0x45).standard_id(), Some(0x645));
        assert_eq!(identity.frame(2), CanFrame::standard(0x602, &[0x40, 0x18, 0x10, 1, 0, 0, 0, 0]));
        assert_eq!(decode_sdo(&[0x43, 0x18, 0x10, 1, 4, 0, 0, 0]), Some((0x1018, 1, SdoAnswer::Value(4))));
        // A multi-turn encoder (book, CANopen: CiA 406 encoders).
        assert_eq!(
            decode_sdo(&[0x43, 0, 0x10, 0, 0x96, 1, 2, 0]),
            Some((0x1000, 0, SdoAnswer::Value(0x0002_0196)))
        );
    }

    /// Texts are recognised by their size and not read; a stray segment of one is no answer.
    #[test]
    fn segments_are_no_answers() {
        let size = decode_sdo(&[0x41, 8, 0x10, 0, 0x1A, 0, 0, 0]);
        assert_eq!(size, Some((0x1008, 0, SdoAnswer::Segmented(26))));
        let segments: [[u8; 8]; 6] = [
            [0x00, 0x46, 0x4C, 0x4F, 0x4F, 0x52, 0x42, 0x4F],
            [0x11, 0x54, 0x2D, 0x44, 0x52, 0x49, 0x56, 0x45],
            [0x00, 0x54, 0x69, 0x6E, 0x79, 0x20, 0x4E, 0x6F],
            [0x10, 0x64, 0x65, 0x20, 0x2D, 0x20, 0x4D, 0x65],
            [0x00, 0x67, 0x61, 0x20, 0x44, 0x6F, 0x6D, 0x61],
            [0x15, 0x69, 0x6E, 0x73, 0x20, 0x21, 0x00, 0x00],
        ];
        assert_eq!(segments.map(|segment| decode_sdo(&segment)), [None; 6]);
    }

    proptest! {
        #[test]
        fn any_payload_is_an_answer_or_none(payload in proptest::collection::vec(any::<u8>(), 0..=8)) {
            let _ = decode_sdo(&payload);
        }
    }
}
