//! Frames to an axis and from it: eleven bits of identifier, of which five are the message; numbers begin with the lowest byte.

use crate::can::CanFrame;

/// Bit of the axis error: the watchdog of the axis has expired.
pub const WATCHDOG_EXPIRED: u32 = 0x0100_0000;
/// The greatest number of an axis.
const NODE_MAX: u16 = 0x3F;

/// What an axis does.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum AxisState {
    /// No torque.
    Idle,
    /// Follows its input.
    ClosedLoop,
    /// Something else: calibration, homing, start-up.
    Other(u8),
}

impl AxisState {
    const fn of(value: u8) -> Self {
        match value {
            1 => Self::Idle,
            8 => Self::ClosedLoop,
            other => Self::Other(other),
        }
    }
}

/// What an axis sends.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum OdriveReport {
    /// Heartbeat, 01h.
    Heartbeat {
        /// Bits of `ODrive.Error`; 0 when all is well.
        error: u32,
        /// What the axis does.
        state: AxisState,
    },
    /// `Get_Error`, 03h.
    Errors {
        /// What is wrong now.
        active: u32,
        /// What took the torque away last.
        disarm_reason: u32,
    },
    /// `Get_Encoder_Estimates`, 09h.
    Estimates {
        /// Turns of the motor since it was powered.
        position_turns: f32,
        /// Turns a second.
        speed_turns_per_s: f32,
    },
    /// `Get_Bus_Voltage_Current`, 17h.
    Bus {
        /// Volts.
        voltage_v: f32,
        /// Amperes; negative: the motor brakes into the supply.
        current_a: f32,
    },
}

/// A report and the axis it comes from.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct OdriveMessage {
    /// Number of the axis.
    pub node: u8,
    /// What it says.
    pub report: OdriveReport,
}

fn number(payload: &[u8], at: usize) -> Option<u32> {
    let bytes = payload.get(at..)?.first_chunk::<4>()?;
    Some(u32::from_le_bytes(*bytes))
}

/// A number with a value: neither infinite nor none.
fn real(payload: &[u8], at: usize) -> Option<f32> {
    number(payload, at).map(f32::from_bits).filter(|value| value.is_finite())
}

impl OdriveMessage {
    /// Decodes a frame; `None`: of another kind, too short, or with a number without value.
    ///
    /// ```
    /// use floorguard_drivers::can::CanFrame;
    /// use floorguard_drivers::odrive::{AxisState, OdriveMessage, OdriveReport};
    ///
    /// let beat = CanFrame::standard(0x021, &[0, 0, 0, 0, 8, 0, 0, 0]);
    /// let report = OdriveReport::Heartbeat { error: 0, state: AxisState::ClosedLoop };
    /// assert_eq!(OdriveMessage::decode(&beat), Some(OdriveMessage { node: 1, report }));
    /// ```
    #[must_use]
    pub fn decode(frame: &CanFrame) -> Option<Self> {
        let (id, payload) = (frame.standard_id()?, frame.payload());
        let node = u8::try_from((id >> 5) & NODE_MAX).ok()?;
        let report = match id & 0x1F {
            0x01 => OdriveReport::Heartbeat {
                error: number(payload, 0)?,
                state: AxisState::of(payload.get(4).copied()?),
            },
            0x03 => OdriveReport::Errors { active: number(payload, 0)?, disarm_reason: number(payload, 4)? },
            0x09 => OdriveReport::Estimates {
                position_turns: real(payload, 0)?,
                speed_turns_per_s: real(payload, 4)?,
            },
            0x17 => OdriveReport::Bus { voltage_v: real(payload, 0)?, current_a: real(payload, 4)? },
            _ => return None,
        };
        Some(Self { node, report })
    }
}

/// What an axis is commanded.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum OdriveOrder {
    /// `Estop`, 02h: no torque at once, and an error until it is cleared.
    EmergencyStop,
    /// `Set_Axis_State`, 07h: no torque.
    Idle,
    /// `Set_Axis_State`, 07h: follow the input.
    ClosedLoop,
    /// `Set_Controller_Mode`, 0Bh: the input is a speed, and is taken as it is.
    FollowSpeed,
    /// `Set_Input_Vel`, 0Dh: turns a second.
    Speed(f32),
    /// `Clear_Errors`, 18h.
    ClearErrors,
}

impl OdriveOrder {
    /// The frame to an axis. A speed without value is a standstill.
    ///
    /// ```
    /// use floorguard_drivers::odrive::OdriveOrder;
    ///
    /// let frame = OdriveOrder::Speed(-1.25).frame(1);
    /// assert_eq!((frame.standard_id(), frame.payload()), (Some(0x02D), &[0, 0, 0xA0, 0xBF, 0, 0, 0, 0][..]));
    /// ```
    #[must_use]
    pub fn frame(self, node: u8) -> CanFrame {
        let two = |first: u32, second: u32| {
            let [[a, b, c, d], [e, f, g, h]] = [first, second].map(u32::to_le_bytes);
            [a, b, c, d, e, f, g, h]
        };
        let id = |command: u16| (u16::from(node) & NODE_MAX) << 5 | command;
        match self {
            Self::EmergencyStop => CanFrame::standard(id(0x02), &[]),
            Self::Idle => CanFrame::standard(id(0x07), &two(1, 0)),
            Self::ClosedLoop => CanFrame::standard(id(0x07), &two(8, 0)),
            Self::FollowSpeed => CanFrame::standard(id(0x0B), &two(2, 1)),
            Self::Speed(turns_per_s) => {
                let turns_per_s = if turns_per_s.is_finite() { turns_per_s } else { 0.0 };
                CanFrame::standard(id(0x0D), &two(turns_per_s.to_bits(), 0))
            }
            Self::ClearErrors => CanFrame::standard(id(0x18), &[0]),
        }
    }
}
