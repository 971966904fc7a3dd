//! A frame of samples as a checked view: after [`SamplesFrame::new_checked`] no accessor can fail.

use crate::link::{CHECKSUM_BYTES, Damage, bytes_at, damage};

/// Positions and values; book, IMU link.
mod field {
    pub const START: [u8; 4] = [b'F', b'G', 1, 6];
    pub const SENDER: u8 = 4;
    pub const SEQUENCE: u8 = 8;
    pub const CLOCK: u8 = 12;
    pub const BETWEEN: u8 = 20;
    pub const SAMPLES: u8 = 24;
    pub const RESERVED: u8 = 25;
    pub const HEAD_BYTES: usize = 28;
    pub const SAMPLE_BYTES: usize = 28;
    /// In a sample.
    pub const FLAGS: u8 = 24;
    pub const FLAGS_RESERVED: u8 = 25;
}

/// With what each frame begins.
pub(super) const START: [u8; 4] = field::START;
/// Bytes that say how long a frame is.
pub(super) const LENGTH_KNOWN: usize = 25;
/// Samples of a frame at most: of a sensor of 1,000 a second a frame then comes every 3 ms.
pub const SAMPLES_MAX: u8 = 3;
/// Bytes of the longest frame.
pub const FRAME_BYTES_MAX: usize = 116;
/// From sample to sample at most, microseconds: slower ones are late before they come.
const BETWEEN_MAX_US: u32 = 50_000;
/// No robot that cleans floors turns faster, rad/s, or is thrown harder, m/s²: what is beyond was never measured.
const RATE_MAX_RADPS: f32 = 100.0;
const ACCELERATION_MAX_MPS2: f32 = 1_000.0;
/// The same as bytes of a frame, for the place of a field.
const HEAD_OFFSET: u8 = 28;
const SAMPLE_OFFSET: u8 = 28;
/// Bits of the flags: the sensor reached the end of its range; it says that it is at fault.
const SATURATED: u8 = 1;
const FAULT: u8 = 2;

/// Why bytes are no frame of samples.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum FrameError {
    /// It does not begin with FG, version 1, kind 6.
    Start([u8; 4]),
    /// Not as long as its samples ask for.
    Length {
        /// Bytes received.
        found: usize,
        /// Bytes of its samples.
        needed: usize,
    },
    /// The checksum is another: damaged on the way.
    Checksum {
        /// What stands in the frame.
        found: u32,
        /// What its bytes come to.
        computed: u32,
    },
    /// A field outside of its range.
    Field {
        /// Offset in the frame, bytes.
        offset: u8,
        /// The value.
        found: u32,
        /// The least and the greatest allowed value.
        allowed: [u32; 2],
    },
    /// A rate or an acceleration is not finite, or beyond what can be measured.
    Value {
        /// The sample.
        sample: u8,
    },
}

impl core::fmt::Display for FrameError {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        match self {
            Self::Start(found) => write!(f, "inertial frame begins with {found:02x?}; expected FG, 1, 6"),
            Self::Length { found, needed } => {
                write!(f, "inertial frame of {found} bytes; its samples have {needed}")
            }
            Self::Checksum { found, computed } => write!(
                f,
                "inertial frame with checksum {found:08x}, its bytes come to {computed:08x}: damaged on the way"
            ),
            Self::Field { offset, found, allowed: [least, most] } => {
                write!(f, "inertial frame: field at byte {offset} is {found}; allowed is {least} to {most}")
            }
            Self::Value { sample } => write!(
                f,
                "inertial frame: sample {sample} is not finite, or beyond 100 rad/s or 1,000 m/s²: correct the bridge's units"
            ),
        }
    }
}

impl core::error::Error for FrameError {}

/// A sample of a frame; axes forward, left, up.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct LinkSample {
    /// Rate of turn, rad/s.
    pub angular_radps: [f32; 3],
    /// Acceleration including gravity, m/s².
    pub linear_mps2: [f32; 3],
    /// The sensor reached the end of its range.
    pub is_saturated: bool,
    /// The sensor says that it is at fault.
    pub is_fault: bool,
}

/// A checked frame.
///
/// # Invariants
/// 1 to 3 samples, finite, within what can be measured; a sender that is not 0; a checksum that is right.
#[derive(Clone, Copy, Debug)]
pub struct SamplesFrame<'a> {
    bytes: &'a [u8],
}

impl<'a> SamplesFrame<'a> {
    /// Checks bytes.
    ///
    /// # Errors
    /// [`FrameError`].
    pub fn new_checked(bytes: &'a [u8]) -> Result<Self, FrameError> {
        let start = bytes.first_chunk::<4>().copied().unwrap_or_default();
        if start != field::START {
            return Err(FrameError::Start(start));
        }
        let frame = Self { bytes };
        let count = u32::from(frame.count());
        if count < 1 || count > u32::from(SAMPLES_MAX) {
            let allowed = [1, u32::from(SAMPLES_MAX)];
            return Err(FrameError::Field { offset: field::SAMPLES, found: count, allowed });
        }
        let needed = frame_bytes(frame.count());
        if bytes.len() != needed {
            return Err(FrameError::Length { found: bytes.len(), needed });
        }
        if let Some(Damage { found, computed }) = damage(bytes) {
            return Err(FrameError::Checksum { found, computed });
        }
        // One sample has nothing between.
        let between_least = u32::from(count > 1);
        let [first, second, third] = bytes_at::<3>(bytes, field::RESERVED);
        let reserved = u32::from(first | second | third);
        let limits = [
            (field::SENDER, frame.sender(), [1, u32::MAX]),
            (field::BETWEEN, frame.between_us(), [between_least, BETWEEN_MAX_US]),
            (field::RESERVED, reserved, [0, 0]),
        ];
        let outside = |(_, found, [least, most]): &(u8, u32, [u32; 2])| found < least || found > most;
        if let Some((offset, found, allowed)) = limits.into_iter().find(outside) {
            return Err(FrameError::Field { offset, found, allowed });
        }
        for (number, sample) in (0_u8..).zip(frame.sample_bytes()) {
            check_sample(number, sample)?;
        }
        Ok(frame)
    }

    /// Who sends; not 0.
    #[must_use]
    pub fn sender(&self) -> u32 {
        u32::from_le_bytes(bytes_at(self.bytes, field::SENDER))
    }

    /// Number of the first sample: one more with each sample; wraps.
    #[must_use]
    pub fn sequence(&self) -> u32 {
        u32::from_le_bytes(bytes_at(self.bytes, field::SEQUENCE))
    }

    /// The sender's clock at the first sample, microseconds.
    #[must_use]
    pub fn first_sample_us(&self) -> u64 {
        u64::from_le_bytes(bytes_at(self.bytes, field::CLOCK))
    }

    /// From sample to sample, microseconds.
    #[must_use]
    pub fn between_us(&self) -> u32 {
        u32::from_le_bytes(bytes_at(self.bytes, field::BETWEEN))
    }

    /// How many samples: 1 to 3.
    #[must_use]
    pub fn count(&self) -> u8 {
        let [count] = bytes_at(self.bytes, field::SAMPLES);
        count
    }

    /// The samples, the oldest first.
    pub fn samples(&self) -> impl Iterator<Item = LinkSample> + use<'a> {
        self.sample_bytes().map(|sample| {
            let [flags] = bytes_at(sample, field::FLAGS);
            LinkSample {
                angular_radps: [0, 4, 8].map(|at| f32::from_le_bytes(bytes_at(sample, at))),
                linear_mps2: [12, 16, 20].map(|at| f32::from_le_bytes(bytes_at(sample, at))),
                is_saturated: flags & SATURATED != 0,
                is_fault: flags & FAULT != 0,
            }
        })
    }

    fn sample_bytes(&self) -> impl Iterator<Item = &'a [u8]> + use<'a> {
        let end = self.bytes.len().saturating_sub(CHECKSUM_BYTES);
        self.bytes.get(field::HEAD_BYTES..end).unwrap_or_default().chunks_exact(field::SAMPLE_BYTES)
    }
}

/// Bytes of a frame of so many samples.
pub(super) fn frame_bytes(samples: u8) -> usize {
    let of_samples = usize::from(samples).saturating_mul(field::SAMPLE_BYTES);
    of_samples.saturating_add(field::HEAD_BYTES + CHECKSUM_BYTES)
}

/// Flags that are known, and numbers that can have been measured.
fn check_sample(number: u8, sample: &[u8]) -> Result<(), FrameError> {
    let [flags, first, second, third] = bytes_at::<4>(sample, field::FLAGS);
    let reserved = first | second | third;
    let offset = |at: u8| at.saturating_add(number.saturating_mul(SAMPLE_OFFSET)).saturating_add(HEAD_OFFSET);
    if flags > SATURATED | FAULT {
        let allowed = [0, u32::from(SATURATED | FAULT)];
        return Err(FrameError::Field { offset: offset(field::FLAGS), found: u32::from(flags), allowed });
    }
    if reserved != 0 {
        let found = u32::from(reserved);
        return Err(FrameError::Field { offset: offset(field::FLAGS_RESERVED), found, allowed: [0, 0] });
    }
    let within = |at: u8, most: f32| f32::from_le_bytes(bytes_at(sample, at)).abs() <= most;
    let is_measured = [0, 4, 8].into_iter().all(|at| within(at, RATE_MAX_RADPS))
        && [12, 16, 20].into_iter().all(|at| within(at, ACCELERATION_MAX_MPS2));
    if is_measured { Ok(()) } else { Err(FrameError::Value { sample: number }) }
}
