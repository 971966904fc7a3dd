//! Frames of a program that drives the robot by velocities, written from the byte tables of the book, Velocity link.
//!
//! The checksum is computed bit by bit and each field is placed at its offset: nothing here knows the robot's codec.

/// Length of a request, bytes.
const REQUEST_BYTES: usize = 32;
/// Length of a permit, bytes.
const PERMIT_BYTES: usize = 236;

/// A request as a program sends it; nothing is checked.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SentVelocity {
    /// Who sends.
    pub sender: u32,
    /// Its number.
    pub sequence: u32,
    /// The sender's clock, milliseconds.
    pub sent_ms: u32,
    /// How long it holds, milliseconds.
    pub deadline_ms: u16,
    /// Forward, m/s.
    pub linear_mps: f32,
    /// Counter-clockwise, rad/s.
    pub angular_radps: f32,
}

impl SentVelocity {
    /// Its bytes.
    #[must_use]
    pub fn encode(&self) -> Vec<u8> {
        let mut bytes = vec![0; REQUEST_BYTES];
        let mut place =
            |offset: usize, field: &[u8]| bytes[offset..offset + field.len()].copy_from_slice(field);
        place(0, b"FG\x01\x01");
        place(4, &self.sender.to_le_bytes());
        place(8, &self.sequence.to_le_bytes());
        place(12, &self.sent_ms.to_le_bytes());
        place(16, &self.deadline_ms.to_le_bytes());
        place(20, &self.linear_mps.to_le_bytes());
        place(24, &self.angular_radps.to_le_bytes());
        let sum = crc32(&bytes[..28]);
        bytes[28..].copy_from_slice(&sum.to_le_bytes());
        bytes
    }
}

/// A request as a base reads it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TakenVelocity {
    /// Its number.
    pub sequence: u32,
    /// How long it holds, milliseconds.
    pub deadline_ms: u16,
    /// 0 drive, 1 hold, 2 brake and torque off, 3 torque off.
    pub stop: u8,
    /// m/s and rad/s.
    pub velocity: [f32; 2],
}

impl TakenVelocity {
    /// Reads a request; none if it is none.
    #[must_use]
    pub fn read(bytes: &[u8]) -> Option<Self> {
        if bytes.len() != REQUEST_BYTES || bytes[..4] != *b"FG\x01\x01" {
            return None;
        }
        let word = |at: usize| u32::from_le_bytes([bytes[at], bytes[at + 1], bytes[at + 2], bytes[at + 3]]);
        let velocity = [f32::from_bits(word(20)), f32::from_bits(word(24))];
        let is_right = word(28) == crc32(&bytes[..28]) && velocity.iter().all(|part| part.is_finite());
        let deadline_ms = u16::from_le_bytes([bytes[16], bytes[17]]);
        is_right.then_some(Self { sequence: word(8), deadline_ms, stop: bytes[18], velocity })
    }
}

/// What a base reports of itself: its number and age in milliseconds, the state of its drive, m/s and rad/s.
#[must_use]
pub fn motion_report((sequence, age_ms): (u32, u16), state: u8, velocity: [f32; 2]) -> Vec<u8> {
    let mut bytes = b"FG\x01\x03".to_vec();
    bytes.extend(1_u32.to_le_bytes());
    bytes.extend(sequence.to_le_bytes());
    bytes.extend(age_ms.to_le_bytes());
    bytes.extend([state, 0, 0, 0, 0, 0]);
    velocity.iter().for_each(|part| bytes.extend(part.to_le_bytes()));
    bytes.extend(crc32(&bytes).to_le_bytes());
    bytes
}

/// What a program reads in a permit.
#[derive(Clone, Debug, PartialEq)]
pub struct HeardPermit {
    /// The sender that is listened to; 0 = none.
    pub sender: u32,
    /// Its number.
    pub sequence: u32,
    /// The newest accepted request.
    pub acknowledged: u32,
    /// The robot's clock, microseconds.
    pub stamp_us: u64,
    /// What the drive gets: m/s and rad/s.
    pub permitted: [f32; 2],
    /// What still holds of the request: m/s and rad/s.
    pub requested: [f32; 2],
    /// What the robot does: m/s and rad/s.
    pub measured: [f32; 2],
    /// Greatest speed, m/s.
    pub speed_limit_mps: f32,
    /// State of the guard.
    pub state: u8,
    /// What the guard demands.
    pub action: u8,
    /// Torque off, escaping, held, expired: bits 0 to 3.
    pub flags: u8,
    /// The cause that holds the robot; 255 = none.
    pub cause: u8,
    /// Every cause that holds.
    pub causes: u64,
    /// Accepted, damaged, not a number, late, out of order, repeated, of another sender.
    pub counters: [u32; 7],
    /// The cause in words.
    pub reason: String,
}

impl HeardPermit {
    /// Reads a permit; none if it is none.
    #[must_use]
    pub fn read(bytes: &[u8]) -> Option<Self> {
        if bytes.len() != PERMIT_BYTES || bytes[..4] != *b"FG\x01\x02" {
            return None;
        }
        let word = |at: usize| u32::from_le_bytes([bytes[at], bytes[at + 1], bytes[at + 2], bytes[at + 3]]);
        if word(PERMIT_BYTES - 4) != crc32(&bytes[..PERMIT_BYTES - 4]) {
            return None;
        }
        let long = |at: usize| u64::from(word(at)) | u64::from(word(at + 4)) << 32;
        let pair = |at: usize| [f32::from_bits(word(at)), f32::from_bits(word(at + 4))];
        let mut counters = [0; 7];
        (0..7).for_each(|index| counters[index] = word(76 + 4 * index));
        let reason = bytes.get(104..104 + usize::from(bytes[73]))?;
        Some(Self {
            sender: word(4),
            sequence: word(8),
            acknowledged: word(12),
            stamp_us: long(16),
            permitted: pair(24),
            requested: pair(32),
            measured: pair(40),
            speed_limit_mps: f32::from_bits(word(48)),
            state: bytes[52],
            action: bytes[53],
            flags: bytes[54],
            cause: bytes[55],
            causes: long(56),
            counters,
            reason: String::from_utf8(reason.to_vec()).ok()?,
        })
    }
}

/// Polynomial 04C11DB7h, reflected, begun and ended inverted.
fn crc32(bytes: &[u8]) -> u32 {
    let shifted = |sum: u32| if sum & 1 == 1 { sum >> 1 ^ 0xEDB8_8320 } else { sum >> 1 };
    !bytes.iter().fold(u32::MAX, |sum, byte| (0..8).fold(sum ^ u32::from(*byte), |sum, _| shifted(sum)))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The first test vector of the book, Velocity link.
    #[test]
    fn request_is_that_of_the_book() {
        let sent = SentVelocity {
            sender: 7,
            sequence: 1,
            sent_ms: 5_000,
            deadline_ms: 150,
            linear_mps: 0.5,
            angular_radps: -0.25,
        };
        let digits: String = sent.encode().iter().map(|byte| format!("{byte:02x}")).collect();
        assert_eq!(digits, "46470101070000000100000088130000960000000000003f000080be3a601443");
        let taken = TakenVelocity { sequence: 1, deadline_ms: 150, stop: 0, velocity: [0.5, -0.25] };
        assert_eq!(TakenVelocity::read(&sent.encode()), Some(taken));
    }
}
