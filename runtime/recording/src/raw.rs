//! The raw bytes of a run in its recording: one topic per line, so that the same tasks can be fed again.

use floorguard_runtime::tape::TapeLine;

/// Raw bytes of a stream, as they came off the wire.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum RawStream {
    /// Lidar datagrams, port 2368.
    Lidar,
    /// Serial line of the safety scanner.
    Scanner,
    /// Serial line of the second safety scanner.
    RearScanner,
    /// Serial line of the inertial unit.
    Imu,
    /// CAN frames towards the robot's computer: identifier in two bytes, little-endian, then the data.
    CanReceived,
    /// CAN frames from the robot's computer, in the same form. Not played again: the tasks make them.
    CanSent,
    /// The operator's buttons: one byte, the number of the tape's line.
    Operator,
    /// The route, in the form of the tape.
    Route,
    /// Orders to the mission, text.
    MissionOrder,
}

impl RawStream {
    /// All streams.
    pub const ALL: [Self; 9] = [
        Self::Lidar,
        Self::Scanner,
        Self::RearScanner,
        Self::Imu,
        Self::CanReceived,
        Self::CanSent,
        Self::Operator,
        Self::Route,
        Self::MissionOrder,
    ];

    /// The topic that holds it.
    #[must_use]
    pub const fn topic(self) -> &'static str {
        match self {
            Self::Lidar => "/raw/lidar",
            Self::Scanner => "/raw/scanner",
            Self::RearScanner => "/raw/rear_scanner",
            Self::Imu => "/raw/imu",
            Self::CanReceived => "/raw/can_received",
            Self::CanSent => "/raw/can_sent",
            Self::Operator => "/raw/operator",
            Self::Route => "/raw/route",
            Self::MissionOrder => "/raw/mission_order",
        }
    }

    /// The stream of a topic.
    #[must_use]
    pub fn of_topic(topic: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|stream| stream.topic() == topic)
    }

    /// Where a line of the tape is recorded.
    #[must_use]
    pub const fn of_line(line: TapeLine) -> Self {
        match line {
            TapeLine::Lidar => Self::Lidar,
            TapeLine::Scanner => Self::Scanner,
            TapeLine::RearScanner => Self::RearScanner,
            TapeLine::Imu => Self::Imu,
            TapeLine::Can => Self::CanReceived,
            TapeLine::Reset | TapeLine::Start | TapeLine::Pause | TapeLine::Resume => Self::Operator,
            TapeLine::Route => Self::Route,
            TapeLine::MissionOrder => Self::MissionOrder,
        }
    }
}
