//! Commands begin with `!`, queries with `?`, settings with `^` and `~`; all end with a carriage return. Replies are `NAME=value`, with
//! a colon between channels, or `+` and `-`.

use core::fmt::Write;

use heapless::String;

use crate::text_lines::whole;

/// No command is longer, bytes.
pub const COMMAND_BYTES_MAX: usize = 24;
/// Bit of the fault flags: the emergency stop holds the power stage off.
pub const EMERGENCY_STOPPED: u16 = 0x10;

/// What a controller of two channels is commanded or asked.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum RoboteqOrder {
    /// `!S`: a channel is to turn at a speed, revolutions a minute.
    Speed {
        /// 1 or 2.
        channel: u8,
        /// Of the motor.
        rpm: i32,
    },
    /// `!EX`: emergency stop, no power until it is released.
    EmergencyStop,
    /// `!MG`: release it.
    Release,
    /// `?S`: speeds of both channels.
    AskSpeeds,
    /// `?C`: counts of both encoders.
    AskCounts,
    /// `?FF`: fault flags.
    AskFaults,
    /// `^RWD`: stop the motors when no command with `!` comes for so many milliseconds; 0 would be never.
    SetWatchdog(u16),
    /// `~RWD`: read that setting.
    AskWatchdog,
}

impl RoboteqOrder {
    /// The characters of the command.
    ///
    /// ```
    /// use floorguard_drivers::roboteq::RoboteqOrder;
    ///
    /// assert_eq!(RoboteqOrder::Speed { channel: 2, rpm: -120 }.text(), "!S 2 -120\r");
    /// ```
    #[must_use]
    pub fn text(self) -> String<COMMAND_BYTES_MAX> {
        let mut text = String::new();
        // The longest is `!S 255 -2147483648`: it fits.
        let _ = match self {
            Self::Speed { channel, rpm } => write!(text, "!S {channel} {rpm}\r"),
            Self::EmergencyStop => text.write_str("!EX\r"),
            Self::Release => text.write_str("!MG\r"),
            Self::AskSpeeds => text.write_str("?S\r"),
            Self::AskCounts => text.write_str("?C\r"),
            Self::AskFaults => text.write_str("?FF\r"),
            Self::SetWatchdog(ms) => write!(text, "^RWD {ms}\r"),
            Self::AskWatchdog => text.write_str("~RWD\r"),
        };
        text
    }
}

/// What a controller answers.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum RoboteqReply {
    /// Revolutions a minute of both channels.
    Speeds([i32; 2]),
    /// Counts of both encoders since the start, wrapping.
    Counts([i32; 2]),
    /// Fault flags; [`EMERGENCY_STOPPED`] is one.
    Faults(u16),
    /// The watchdog's time, milliseconds; 0 is never.
    Watchdog(u32),
    /// `+`: the last command was taken.
    Accepted,
    /// `-`: it was not.
    Refused,
}

fn pair(text: &[u8]) -> Option<[i32; 2]> {
    let mut parts = text.split(|byte| *byte == b':');
    let both = [whole(parts.next()?)?, whole(parts.next()?)?];
    parts.next().is_none().then_some(both)
}

impl RoboteqReply {
    /// Decodes a line without its end; `None`: the echo of a command, another answer, or damaged.
    ///
    /// ```
    /// use floorguard_drivers::roboteq::RoboteqReply;
    ///
    /// assert_eq!(RoboteqReply::decode(b"C=12:-7"), Some(RoboteqReply::Counts([12, -7])));
    /// assert_eq!(RoboteqReply::decode(b"?C"), None);
    /// ```
    #[must_use]
    pub fn decode(line: &[u8]) -> Option<Self> {
        match line {
            b"+" => return Some(Self::Accepted),
            b"-" => return Some(Self::Refused),
            _ => {}
        }
        let split = line.iter().position(|byte| *byte == b'=')?;
        let (name, value) = (line.get(..split)?, line.get(split.saturating_add(1)..)?);
        Some(match name {
            b"S" => Self::Speeds(pair(value)?),
            b"C" => Self::Counts(pair(value)?),
            b"FF" => Self::Faults(whole(value)?),
            b"RWD" => Self::Watchdog(whole(value)?),
            _ => return None,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    /// As the manual writes them: `!S nn mm`, `?S`, `?C`, `?FF`, `^RWD nn`, `~RWD`, `!EX`, `!MG`; with the number 2000 the watchdog waits 2 s.
    #[test]
    fn commands_are_those_of_the_manual() {
        let table = [
            (RoboteqOrder::Speed { channel: 1, rpm: 2_500 }, "!S 1 2500\r"),
            (RoboteqOrder::EmergencyStop, "!EX\r"),
            (RoboteqOrder::Release, "!MG\r"),
            (RoboteqOrder::AskSpeeds, "?S\r"),
            (RoboteqOrder::AskCounts, "?C\r"),
            (RoboteqOrder::AskFaults, "?FF\r"),
            (RoboteqOrder::SetWatchdog(2_000), "^RWD 2000\r"),
            (RoboteqOrder::AskWatchdog, "~RWD\r"),
            (RoboteqOrder::Speed { channel: 255, rpm: i32::MIN }, "!S 255 -2147483648\r"),
        ];
        for (order, text) in table {
            assert_eq!(order.text(), text);
        }
    }

    #[test]
    fn replies_differ_from_echoes() {
        let table: [(&[u8], Option<RoboteqReply>); 12] = [
            (b"S=100:-200", Some(RoboteqReply::Speeds([100, -200]))),
            (b"C=-2147483648:2147483647", Some(RoboteqReply::Counts([i32::MIN, i32::MAX]))),
            (b"FF=16", Some(RoboteqReply::Faults(EMERGENCY_STOPPED))),
            (b"RWD=200", Some(RoboteqReply::Watchdog(200))),
            (b"+", Some(RoboteqReply::Accepted)),
            (b"-", Some(RoboteqReply::Refused)),
            (b"!S 1 100", None),
            (b"S=100", None),
            (b"S=100:1:2", None),
            (b"C=2147483648:0", None),
            (b"FF=-1", None),
            (b"BA=3:4", None),
        ];
        for (line, reply) in table {
            assert_eq!(RoboteqReply::decode(line), reply, "{}", std::string::String::from_utf8_lossy(line));
        }
    }

    proptest! {
        #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::default() })]

        #[test]
        fn any_line_is_survived(line in proptest::collection::vec(any::<u8>(), 0..40)) {
            let _ = RoboteqReply::decode(&line);
        }
    }
}
