//! What the guard permits, and why not more; book, Velocity link: Permit.

use core::fmt::Write as _;

use floorguard_types::geometry::Twist2;
use floorguard_types::time::Stamp;

use super::acceptance::LinkCounters;
use super::frame::{self, FrameError, FrameWriter};
use super::reason::Reason;

/// Length of a permit.
pub const PERMIT_BYTES: usize = 236;
/// The cause of a permit that nothing holds.
pub const NO_CAUSE: u8 = u8::MAX;

/// Offset of the length of the reason.
const REASON_LENGTH: usize = 73;
/// Offset of the reason.
const REASON: usize = 104;

/// What is true at the moment of a permit.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct PermitFlags {
    /// The drive's torque is off, or about to be.
    pub torque_off: bool,
    /// The robot leaves an obstacle at escape speed although a stop is in force.
    pub escaping: bool,
    /// A sender is listened to.
    pub is_held: bool,
    /// The newest request is past its deadline: the requested velocity is zero.
    pub is_expired: bool,
}

impl PermitFlags {
    fn bits(self) -> u8 {
        let flags = [(self.torque_off, 1), (self.escaping, 2), (self.is_held, 4), (self.is_expired, 8)];
        flags.into_iter().fold(0, |bits, (is_set, bit)| if is_set { bits | bit } else { bits })
    }

    const fn from_bits(bits: u8) -> Self {
        Self {
            torque_off: bits & 1 != 0,
            escaping: bits & 2 != 0,
            is_held: bits & 4 != 0,
            is_expired: bits & 8 != 0,
        }
    }
}

/// What the guard permits now. The numbers of states, actions, causes and units are those of the book, Velocity link.
#[derive(Clone, Debug, PartialEq)]
pub struct Permit {
    /// The sender that is listened to; 0 = none.
    pub sender: u32,
    /// Grows by 1 with each permit, and wraps.
    pub sequence: u32,
    /// Sequence of the newest accepted request; 0 before the first.
    pub acknowledged: u32,
    /// When it was sent, on the robot's clock.
    pub stamp: Stamp,
    /// What the drive gets, m/s and rad/s.
    pub permitted: Twist2,
    /// What was asked for and still holds; zero after the deadline.
    pub requested: Twist2,
    /// What the robot does, measured.
    pub measured: Twist2,
    /// Greatest speed that is permitted now, m/s.
    pub speed_limit_mps: f32,
    /// State of the guard: 0 init, 1 run, 2 slow, 3 stop, 4 latched, 5 awaits start.
    pub state: u8,
    /// What the guard demands: 0 none, 1 limit, 2, 3, 4 stop of category 2, 1, 0.
    pub action: u8,
    /// What else is true.
    pub flags: PermitFlags,
    /// The cause that holds the robot; [`NO_CAUSE`] if none does.
    pub cause: u8,
    /// Every cause that holds, one bit for each.
    pub causes: u64,
    /// What the holding cause measured, in `unit`.
    pub value: f32,
    /// The limit that it broke, in `unit`.
    pub limit: f32,
    /// Unit of both: 0 none, 1 m, 2 m/s, 3 rad/s, 4 s, 5 %, 6 a device's code.
    pub unit: u8,
    /// What became of the requests.
    pub counters: LinkCounters,
    /// The holding cause in words; empty if none holds.
    pub reason: Reason,
}

impl Permit {
    /// Reads a datagram, or a frame of a line.
    ///
    /// # Errors
    /// It is no permit, or its reason is no text.
    pub fn decode(bytes: &[u8]) -> Result<Self, FrameError> {
        let mut fields = frame::checked(bytes, frame::PERMIT)?;
        let (sender, sequence, acknowledged) = (fields.word(), fields.word(), fields.word());
        let stamp = Stamp::from_micros(fields.long());
        let [permitted, requested, measured] = [(); 3].map(|()| twist(&mut fields));
        let speed_limit_mps = fields.number();
        let (state, action) = (fields.byte(), fields.byte());
        let (flags, cause) = (PermitFlags::from_bits(fields.byte()), fields.byte());
        let causes = fields.long();
        let (value, limit) = (fields.number(), fields.number());
        let (unit, length) = (fields.byte(), fields.byte());
        let _reserved = fields.short();
        let counters = LinkCounters {
            accepted: fields.word(),
            damaged: fields.word(),
            non_finite: fields.word(),
            late: fields.word(),
            out_of_order: fields.word(),
            repeated: fields.word(),
            other_sender: fields.word(),
        };
        let wrong = |offset, found| FrameError::Field { offset, found };
        let text = fields.rest().get(..usize::from(length));
        let text = text.ok_or(wrong(REASON_LENGTH, u32::from(length)))?;
        let text = core::str::from_utf8(text).map_err(|_| wrong(REASON, u32::from(length)))?;
        let mut reason = Reason::EMPTY;
        reason.write_str(text).map_err(|_| wrong(REASON_LENGTH, u32::from(length)))?;
        Ok(Self {
            sender,
            sequence,
            acknowledged,
            stamp,
            permitted,
            requested,
            measured,
            speed_limit_mps,
            state,
            action,
            flags,
            cause,
            causes,
            value,
            limit,
            unit,
            counters,
            reason,
        })
    }

    /// Its bytes.
    #[must_use]
    pub fn encode(&self) -> [u8; PERMIT_BYTES] {
        let counters = &self.counters;
        let mut frame = FrameWriter::new(frame::PERMIT)
            .put(self.sender.to_le_bytes())
            .put(self.sequence.to_le_bytes())
            .put(self.acknowledged.to_le_bytes())
            .put(self.stamp.as_micros().to_le_bytes());
        for twist in [self.permitted, self.requested, self.measured] {
            frame = frame.put(twist.linear_mps.to_le_bytes()).put(twist.angular_radps.to_le_bytes());
        }
        frame = frame
            .put(self.speed_limit_mps.to_le_bytes())
            .put([self.state, self.action, self.flags.bits(), self.cause])
            .put(self.causes.to_le_bytes())
            .put(self.value.to_le_bytes())
            .put(self.limit.to_le_bytes())
            .put([self.unit, u8::try_from(self.reason.length()).unwrap_or(0), 0, 0]);
        for count in [
            counters.accepted,
            counters.damaged,
            counters.non_finite,
            counters.late,
            counters.out_of_order,
            counters.repeated,
            counters.other_sender,
        ] {
            frame = frame.put(count.to_le_bytes());
        }
        frame.put(*self.reason.bytes()).finish()
    }
}

fn twist(fields: &mut frame::Fields<'_>) -> Twist2 {
    Twist2 { linear_mps: fields.number(), angular_radps: fields.number() }
}
