//! What a sensor answers: a descriptor, then one answer or answers without end; of those the plain one, a node of one sample.

use floorguard_types::number::truncating_u8;

/// A turn, sixty-fourths of a degree.
pub(super) const TURN_Q6: u16 = 360 * 64;
/// Bytes of a descriptor.
pub(super) const DESCRIPTOR_BYTES: usize = 7;
/// Bytes of a node.
pub(super) const NODE_BYTES: usize = 5;

/// Answers that hold samples.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum AnswerKind {
    /// One sample, with its angle.
    Node,
    /// 32 samples, with the angle of the first.
    Capsule,
    /// 40 samples, with the angle of the first.
    DenseCapsule,
}

/// What stands before an answer.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Descriptor {
    /// Bytes of an answer, below 2³⁰.
    pub bytes: u32,
    /// More than one will come.
    pub is_stream: bool,
    /// What it is.
    pub kind: u8,
}

impl Descriptor {
    /// Of the health of the sensor: status, error code.
    pub const HEALTH: Self = Self { bytes: 3, is_stream: false, kind: 0x06 };

    /// Reads the seven bytes; `None`: they are none.
    #[must_use]
    pub const fn decode(bytes: &[u8; DESCRIPTOR_BYTES]) -> Option<Self> {
        let [0xA5, 0x5A, a, b, c, d, kind] = *bytes else { return None };
        let word = u32::from_le_bytes([a, b, c, d]);
        Some(Self { bytes: word & 0x3FFF_FFFF, is_stream: word >> 30 == 1, kind })
    }

    /// Which samples follow, if it is samples.
    #[must_use]
    pub const fn samples(self) -> Option<AnswerKind> {
        match (self.kind, self.bytes, self.is_stream) {
            (0x81, 5, true) => Some(AnswerKind::Node),
            (0x82, 84, true) => Some(AnswerKind::Capsule),
            (0x85, 84, true) => Some(AnswerKind::DenseCapsule),
            _ => None,
        }
    }
}

/// One measurement.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Sample {
    /// Clockwise from the front as seen from above, sixty-fourths of a degree, below 23,040.
    pub angle_q6: u16,
    /// Millimetres; 0: nothing came back.
    pub range_mm: u16,
}

/// Why five bytes are no node.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum NodeError {
    /// A check bit is wrong.
    CheckBits,
    /// An angle beyond a turn, sixty-fourths of a degree.
    Angle(u16),
}

/// Reads a node.
///
/// # Errors
/// [`NodeError`]: the bytes begin elsewhere.
pub fn decode_node(bytes: &[u8; NODE_BYTES]) -> Result<Sample, NodeError> {
    let [start, low, high, range_low, range_high] = *bytes;
    let is_start = start & 1 != 0;
    let is_not_start = start & 2 != 0;
    if is_start == is_not_start || low & 1 == 0 {
        return Err(NodeError::CheckBits);
    }
    let angle_q6 = u16::from_le_bytes([low, high]) >> 1;
    if angle_q6 >= TURN_Q6 {
        return Err(NodeError::Angle(angle_q6));
    }
    // Quarters of a millimetre.
    Ok(Sample { angle_q6, range_mm: u16::from_le_bytes([range_low, range_high]) >> 2 })
}

/// A request: its command, and a payload with its length and the exclusive-or of all bytes.
pub(super) fn request(command: u8, payload: &[u8], send: &mut impl FnMut(&[u8])) {
    let length = truncating_u8(payload.len());
    let start = [0xA5, command, length];
    if payload.is_empty() {
        let [sync, command, _] = start;
        return send(&[sync, command]);
    }
    let check = start.iter().chain(payload).fold(0, |check, byte| check ^ byte);
    send(&start);
    send(payload);
    send(&[check]);
}
