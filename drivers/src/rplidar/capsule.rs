//! Capsules as checked views: many samples, with the angle of the first one. The angles of the others need the next capsule.

use floorguard_types::number::truncating_u16;

use super::answer::{AnswerKind, Sample, TURN_Q6};

/// Bytes of a capsule of either kind.
pub const CAPSULE_BYTES: usize = 84;
const HEAD_BYTES: usize = 4;
/// A turn in 65,536ths of a degree.
const TURN_Q16: i32 = 360 << 16;
/// From a capsule to the next the head turns less: 32 samples of 2,000 a second at ten turns a second are 58°.
const STEP_MAX_Q6: u16 = 60 * 64;

/// Why 84 bytes are no capsule.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum CapsuleError {
    /// It does not begin with the two marks.
    Start,
    /// The exclusive-or of its bytes is another one than it says.
    Checksum {
        /// Of its bytes.
        found: u8,
        /// That it says.
        announced: u8,
    },
    /// An angle beyond a turn, sixty-fourths of a degree.
    Angle(u16),
}

/// A checked capsule.
///
/// # Invariants
/// Marks and checksum are right; its angle is below a turn.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Capsule {
    kind: AnswerKind,
    bytes: [u8; CAPSULE_BYTES],
    angle_q6: u16,
}

impl Capsule {
    /// Checks the bytes.
    ///
    /// # Errors
    /// [`CapsuleError`].
    pub fn new_checked(kind: AnswerKind, bytes: &[u8; CAPSULE_BYTES]) -> Result<Self, CapsuleError> {
        let [first, second, low, high, ..] = *bytes;
        if !is_first(first) || !is_second(second) {
            return Err(CapsuleError::Start);
        }
        let announced = (first & 0x0F) | (second << 4);
        let found = bytes.iter().skip(2).fold(0, |check, byte| check ^ byte);
        if found != announced {
            return Err(CapsuleError::Checksum { found, announced });
        }
        let angle_q6 = u16::from_le_bytes([low, high]) & 0x7FFF;
        if angle_q6 >= TURN_Q6 {
            return Err(CapsuleError::Angle(angle_q6));
        }
        Ok(Self { kind, bytes: *bytes, angle_q6 })
    }

    /// The first one since the sensor was asked: what came before belongs to no turn that goes on.
    #[must_use]
    pub const fn is_first(&self) -> bool {
        let [_, _, _, high, ..] = self.bytes;
        high & 0x80 != 0
    }

    /// Angle of its first sample, sixty-fourths of a degree.
    #[must_use]
    pub const fn angle_q6(&self) -> u16 {
        self.angle_q6
    }

    /// Its samples, which end where the next capsule begins. None if the head has turned farther than it can: capsules between the two
    /// are lost, and where the samples were measured is not known.
    pub fn samples(&self, next: &Self) -> impl Iterator<Item = Sample> + use<> {
        let turned_q6 = match next.angle_q6.checked_sub(self.angle_q6) {
            Some(turned_q6) => turned_q6,
            None => next.angle_q6.saturating_add(TURN_Q6.saturating_sub(self.angle_q6)),
        };
        let count = match self.kind {
            AnswerKind::DenseCapsule => 40,
            AnswerKind::Capsule | AnswerKind::Node => 32,
        };
        let step_q16 = (i32::from(turned_q6) << 10) / count;
        let first_q16 = i32::from(self.angle_q6) << 10;
        let is_whole = turned_q6 <= STEP_MAX_Q6;
        let (kind, bytes) = (self.kind, self.bytes);
        let of_sample = move |index: u16| {
            let (range_mm, earlier_q3) = cell(kind, &bytes, usize::from(index))?;
            let turned_q16 = step_q16.saturating_mul(i32::from(index));
            let angle_q16 = first_q16.saturating_add(turned_q16).saturating_sub(i32::from(earlier_q3) << 13);
            let angle_q6 = truncating_u16(angle_q16.rem_euclid(TURN_Q16) >> 10);
            Some(Sample { angle_q6, range_mm })
        };
        (0..40).filter(move |index| is_whole && i32::from(*index) < count).filter_map(of_sample)
    }
}

/// Range of a sample, millimetres, and by how much its laser looked before the even step, eighths of a degree.
fn cell(kind: AnswerKind, bytes: &[u8; CAPSULE_BYTES], index: usize) -> Option<(u16, u8)> {
    let cells = bytes.get(HEAD_BYTES..)?;
    match kind {
        AnswerKind::DenseCapsule => {
            let [low, high] = *cells.as_chunks::<2>().0.get(index)?;
            Some((u16::from_le_bytes([low, high]), 0))
        }
        AnswerKind::Capsule | AnswerKind::Node => {
            let [low_a, high_a, low_b, high_b, angles] = *cells.as_chunks::<5>().0.get(index >> 1)?;
            let (low, high, angle) = match index & 1 {
                0 => (low_a, high_a, angles & 0x0F),
                _ => (low_b, high_b, angles >> 4),
            };
            // Two bits of the range's word are the high ones of the angle.
            Some((u16::from_le_bytes([low, high]) >> 2, angle | ((low & 3) << 4)))
        }
    }
}

/// A first byte.
pub(super) const fn is_first(byte: u8) -> bool {
    byte >> 4 == 0xA
}

/// A second byte.
pub(super) const fn is_second(byte: u8) -> bool {
    byte >> 4 == 0x5
}
