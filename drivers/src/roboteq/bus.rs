//! Objects of the controller and the process data that carry them: numbers begin with the lowest byte.

use floorguard_types::number::truncating_u8;

use crate::can::CanFrame;
use crate::canopen::{Script, SdoRequest};

/// Channels of a controller.
pub const BUS_CHANNELS: usize = 2;
/// Bit of the status flags: a script runs in the controller.
pub const SCRIPT_RUNS: u16 = 0x80;
/// The user variable in which the controller's script shows its watchdog.
pub const WATCHDOG_VARIABLE: u8 = 1;

/// Emergency shutdown (EX), 8 bits.
const EMERGENCY_SHUTDOWN: u16 = 0x200C;
/// Release of the shutdown (MG), 8 bits.
const RELEASE_SHUTDOWN: u16 = 0x200D;
/// User integer variables, to write, 32 bits.
const SET_VARIABLE: u16 = 0x2005;
/// Speed of each motor (S), turns a minute, 32 bits.
const SET_SPEED: [u32; BUS_CHANNELS] = [0x2002_0120, 0x2002_0220];
/// Speed of each encoder (S), turns a minute, 32 bits.
const SPEEDS: [u32; BUS_CHANNELS] = [0x2103_0120, 0x2103_0220];
/// Count of each encoder (C), 32 bits.
const COUNTS: [u32; BUS_CHANNELS] = [0x2104_0120, 0x2104_0220];
/// Fault flags (FF) and status flags (FS), 16 bits, and the variable that shows the watchdog, 32 bits.
const STATE: [u32; 3] =
    [0x2112_0010, 0x2111_0010, 0x2106_0020 | u32::from_be_bytes([0, 0, WATCHDOG_VARIABLE, 0])];

/// Heartbeat of the controller, milliseconds.
const HEARTBEAT_MS: u32 = 100;
/// So often counts and speeds come, milliseconds.
const MOTION_MS: u32 = 10;
/// So often the flags come, milliseconds.
const STATE_MS: u32 = 20;
/// In the identifier of process data: not to be used.
const OFF: u32 = 0x8000_0000;
/// In the identifier of process data of the device: not to be requested. The maker's file has it set.
const UNREQUESTED: u32 = 0x4000_0000;
/// Transmission type: by event, and by the timer.
const BY_EVENT: u32 = 255;

/// What a controller sends of itself.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum RoboteqBusReport {
    /// TPDO1: counts of the encoders since the start, wrapping; 0 where there is none.
    Counts([i32; BUS_CHANNELS]),
    /// TPDO2: turns of the motors a minute; 0 where there is none.
    Speeds([i32; BUS_CHANNELS]),
    /// TPDO3.
    State {
        /// Fault flags; [`EMERGENCY_STOPPED`](super::EMERGENCY_STOPPED) is one.
        faults: u16,
        /// Status flags; [`SCRIPT_RUNS`] is one.
        status: u16,
        /// What the script read of the watchdog, milliseconds; 0: never, or nothing was read.
        watchdog_ms: i32,
    },
}

impl RoboteqBusReport {
    /// Decodes process data of a controller with one or two channels; `None`: of another kind, or cut.
    ///
    /// ```
    /// use floorguard_drivers::can::CanFrame;
    /// use floorguard_drivers::roboteq::RoboteqBusReport;
    ///
    /// let frame = CanFrame::standard(0x28C, &[0x88, 0xFF, 0xFF, 0xFF, 0xC4, 0x09, 0x00, 0x00]);
    /// assert_eq!(RoboteqBusReport::decode(&frame, 2), Some((12, RoboteqBusReport::Speeds([-120, 2_500]))));
    /// ```
    #[must_use]
    pub fn decode(frame: &CanFrame, channels: usize) -> Option<(u8, Self)> {
        let (id, payload) = (frame.standard_id()?, frame.payload());
        let report = match id & 0x780 {
            0x180 => Self::Counts(numbers(payload, channels)?),
            0x280 => Self::Speeds(numbers(payload, channels)?),
            0x380 => {
                let &[fault_low, fault_high, status_low, status_high, a, b, c, d] = payload else {
                    return None;
                };
                Self::State {
                    faults: u16::from_le_bytes([fault_low, fault_high]),
                    status: u16::from_le_bytes([status_low, status_high]),
                    watchdog_ms: i32::from_le_bytes([a, b, c, d]),
                }
            }
            _ => return None,
        };
        Some((truncating_u8(id & 0x7F), report))
    }
}

fn numbers(payload: &[u8], channels: usize) -> Option<[i32; BUS_CHANNELS]> {
    let mut values = [0; BUS_CHANNELS];
    for (channel, value) in values.iter_mut().enumerate().take(channels) {
        let bytes = payload.get(channel.saturating_mul(4)..)?.first_chunk::<4>()?;
        *value = i32::from_le_bytes(*bytes);
    }
    Some(values)
}

/// What a controller is commanded.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum RoboteqBusOrder {
    /// RPDO1: turns of the motors a minute, of so many channels.
    Speeds {
        /// Of both motors.
        rpm: [i32; BUS_CHANNELS],
        /// 1 or 2.
        channels: usize,
    },
    /// SDO: no power until it is released.
    EmergencyStop,
    /// SDO: release it.
    Release,
}

impl RoboteqBusOrder {
    /// The frame to a controller.
    ///
    /// ```
    /// use floorguard_drivers::can::CanFrame;
    /// use floorguard_drivers::roboteq::RoboteqBusOrder;
    ///
    /// let wanted = CanFrame::standard(0x60C, &[0x2F, 0x0C, 0x20, 0x00, 0x01, 0x00, 0x00, 0x00]);
    /// assert_eq!(RoboteqBusOrder::EmergencyStop.frame(12), wanted);
    /// ```
    #[must_use]
    pub fn frame(self, node: u8) -> CanFrame {
        let command = |index| SdoRequest { index, subindex: 0, write: Some((1, 1)) }.frame(node);
        match self {
            Self::Speeds { rpm: [first, second], channels } => {
                let [[a, b, c, d], [e, f, g, h]] = [first, second].map(i32::to_le_bytes);
                let id = 0x200 | u16::from(node & 0x7F);
                let (one, both) = ([a, b, c, d], [a, b, c, d, e, f, g, h]);
                CanFrame::standard(id, if channels < BUS_CHANNELS { &one } else { &both })
            }
            Self::EmergencyStop => command(EMERGENCY_SHUTDOWN),
            Self::Release => command(RELEASE_SHUTDOWN),
        }
    }
}

/// What a controller is configured to do at its start. First of all it stops: if a former master made it turn, it must not go on. What its
/// script showed of the watchdog is wiped out, so that the script must show it again.
#[must_use]
pub fn bus_script(node: u8, channels: usize) -> Script {
    let mapped = |objects: &'static [u32; BUS_CHANNELS]| objects.get(..channels).unwrap_or(objects);
    let script = Script::new()
        .write(EMERGENCY_SHUTDOWN, 0, 1, 1)
        .write(SET_VARIABLE, WATCHDOG_VARIABLE, 0, 4)
        .write(0x1017, 0, HEARTBEAT_MS, 2)
        .receive(node, 0, (255, mapped(&SET_SPEED)));
    let script = timed(script, (node, 0), (MOTION_MS, mapped(&COUNTS)));
    let script = timed(script, (node, 1), (MOTION_MS, mapped(&SPEEDS)));
    timed(script, (node, 2), (STATE_MS, &STATE))
}

/// Process data of the device that come by its event timer. Switched off while they are set up.
fn timed(script: Script, (node, pdo): (u8, u16), (period_ms, mapped): (u32, &[u32])) -> Script {
    let (communication, mapping) = (0x1800 | pdo, 0x1A00 | pdo);
    let id = UNREQUESTED | (0x180 + (u32::from(pdo) << 8)) | u32::from(node & 0x7F);
    let mut script = script
        .write(communication, 1, OFF | id, 4)
        .write(communication, 2, BY_EVENT, 1)
        .write(communication, 5, period_ms, 2)
        .write(mapping, 0, 0, 1);
    let mut count = 0_u8;
    for object in mapped {
        count = count.saturating_add(1);
        script = script.write(mapping, count, *object, 4);
    }
    script.write(mapping, 0, u32::from(count), 1).write(communication, 1, id, 4)
}
