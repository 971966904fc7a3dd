//! A requested velocity; book, Velocity link: Request.

use core::ops::RangeInclusive;

use floorguard_types::geometry::Twist2;

use super::frame::{self, FrameError, FrameWriter};

/// Length of a request.
pub const REQUEST_BYTES: usize = 32;
/// What a request may live, milliseconds: shorter is less than two periods of the guard's tick, longer is no supervision.
pub const DEADLINE_MS: RangeInclusive<u16> = 20..=1_000;

/// Offsets of the fields whose values are checked.
pub(super) mod field {
    pub const SENDER: usize = 4;
    pub const DEADLINE: usize = 16;
    pub const STOP: usize = 18;
    pub const RESERVED: usize = 19;
}

/// What a base is to do beside driving the velocity. A navigation stack sends [`Self::None`].
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum StopDemand {
    /// Drive the velocity.
    #[default]
    None,
    /// Brake and hold, power on: category 2 of IEC 60204-1.
    Hold,
    /// Brake, then torque off: category 1.
    Ramp,
    /// Torque off at once: category 0.
    TorqueOff,
}

impl StopDemand {
    const ALL: [Self; 4] = [Self::None, Self::Hold, Self::Ramp, Self::TorqueOff];

    pub(super) const fn code(self) -> u8 {
        match self {
            Self::None => 0,
            Self::Hold => 1,
            Self::Ramp => 2,
            Self::TorqueOff => 3,
        }
    }
}

/// A velocity that is asked for: by a navigation stack from the guard, or by the guard from a base.
///
/// ```
/// use floorguard_drivers::velocity_link::{FrameError, StopDemand, VelocityRequest};
/// use floorguard_types::geometry::Twist2;
///
/// let request = VelocityRequest {
///     sender: 7,
///     sequence: 1,
///     sent_ms: 5_000,
///     deadline_ms: 150,
///     stop: StopDemand::None,
///     twist: Twist2 { linear_mps: 0.5, angular_radps: -0.1 },
/// };
/// let mut bytes = request.encode();
/// assert_eq!(VelocityRequest::decode(&bytes), Ok(request));
/// bytes[20] ^= 1;
/// assert!(matches!(VelocityRequest::decode(&bytes), Err(FrameError::Checksum { .. })));
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct VelocityRequest {
    /// Who asks; not 0.
    pub sender: u32,
    /// Grows by 1 with each request, and wraps.
    pub sequence: u32,
    /// The sender's own clock when it sent, milliseconds; wraps.
    pub sent_ms: u32,
    /// How long the request holds from its sending on, milliseconds, in [`DEADLINE_MS`].
    pub deadline_ms: u16,
    /// What a base is to do.
    pub stop: StopDemand,
    /// In the robot's frame, m/s and rad/s, finite.
    pub twist: Twist2,
}

impl VelocityRequest {
    /// Reads a datagram, or a frame of a line.
    ///
    /// # Errors
    /// It is no request, or a field is outside of its range.
    pub fn decode(bytes: &[u8]) -> Result<Self, FrameError> {
        let mut fields = frame::checked(bytes, frame::REQUEST)?;
        let (sender, sequence, sent_ms) = (fields.word(), fields.word(), fields.word());
        let deadline_ms = fields.short();
        let (stop, reserved) = (fields.byte(), fields.byte());
        let twist = Twist2 { linear_mps: fields.number(), angular_radps: fields.number() };
        let wrong = |offset, found: u32| Err(FrameError::Field { offset, found });
        let Some(demand) = StopDemand::ALL.get(usize::from(stop)).copied() else {
            return wrong(field::STOP, u32::from(stop));
        };
        if sender == 0 {
            return wrong(field::SENDER, sender);
        }
        if !DEADLINE_MS.contains(&deadline_ms) {
            return wrong(field::DEADLINE, u32::from(deadline_ms));
        }
        if reserved != 0 {
            return wrong(field::RESERVED, u32::from(reserved));
        }
        if !twist.is_finite() {
            return Err(FrameError::NonFinite);
        }
        Ok(Self { sender, sequence, sent_ms, deadline_ms, stop: demand, twist })
    }

    /// Its bytes.
    #[must_use]
    pub fn encode(&self) -> [u8; REQUEST_BYTES] {
        FrameWriter::new(frame::REQUEST)
            .put(self.sender.to_le_bytes())
            .put(self.sequence.to_le_bytes())
            .put(self.sent_ms.to_le_bytes())
            .put(self.deadline_ms.to_le_bytes())
            .put([self.stop.code(), 0])
            .put(self.twist.linear_mps.to_le_bytes())
            .put(self.twist.angular_radps.to_le_bytes())
            .finish()
    }
}
