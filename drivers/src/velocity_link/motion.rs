//! What a base that takes velocities measures of itself; book, Velocity link: Motion report.

use floorguard_types::geometry::Twist2;
use floorguard_types::sensing::DriveState;

use super::frame::{self, FrameError, FrameWriter};

/// Length of a report.
pub const MOTION_BYTES: usize = 32;

/// Offset of the state.
const STATE: usize = 14;

/// Measured by a base, not commanded: an echo of the command would hide a drive that does not follow.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MotionReport {
    /// Which base; not checked.
    pub sender: u32,
    /// Grows by 1 with each report, and wraps.
    pub sequence: u32,
    /// Age of the measurement when it was sent, milliseconds.
    pub age_ms: u16,
    /// What the drive does.
    pub state: DriveState,
    /// In the robot's frame, m/s and rad/s, finite.
    pub twist: Twist2,
}

impl MotionReport {
    /// Reads a datagram, or a frame of a line.
    ///
    /// # Errors
    /// It is no report, or a field is outside of its range.
    pub fn decode(bytes: &[u8]) -> Result<Self, FrameError> {
        let mut fields = frame::checked(bytes, frame::MOTION)?;
        let (sender, sequence, age_ms) = (fields.word(), fields.word(), fields.short());
        let (state, _reserved, code) = (fields.byte(), fields.byte(), fields.short());
        let _reserved = fields.short();
        let twist = Twist2 { linear_mps: fields.number(), angular_radps: fields.number() };
        let state = match state {
            0 => DriveState::Unknown,
            1 => DriveState::Disabled,
            2 => DriveState::Enabled,
            3 => DriveState::QuickStop,
            4 => DriveState::Fault(code),
            _ => return Err(FrameError::Field { offset: STATE, found: u32::from(state) }),
        };
        if !twist.is_finite() {
            return Err(FrameError::NonFinite);
        }
        Ok(Self { sender, sequence, age_ms, state, twist })
    }

    /// Its bytes.
    #[must_use]
    pub fn encode(&self) -> [u8; MOTION_BYTES] {
        let (state, code) = match self.state {
            DriveState::Unknown => (0, 0),
            DriveState::Disabled => (1, 0),
            DriveState::Enabled => (2, 0),
            DriveState::QuickStop => (3, 0),
            DriveState::Fault(code) => (4, code),
        };
        FrameWriter::new(frame::MOTION)
            .put(self.sender.to_le_bytes())
            .put(self.sequence.to_le_bytes())
            .put(self.age_ms.to_le_bytes())
            .put([state, 0])
            .put(code.to_le_bytes())
            .put([0; 2])
            .put(self.twist.linear_mps.to_le_bytes())
            .put(self.twist.angular_radps.to_le_bytes())
            .finish()
    }
}
