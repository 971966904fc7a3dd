//! Raw messages of a recording as deliveries to the tasks.

use floorguard_runtime::tape::TapeLine;

use crate::{RawStream, Recorded, octets_of};

/// What a message of the recording delivered to the tasks.
pub(super) fn delivery(recorded: &Recorded) -> Option<(TapeLine, &[u8])> {
    let stream = RawStream::of_topic(&recorded.topic)?;
    let bytes = octets_of(&recorded.data)?;
    let line = match stream {
        RawStream::Lidar => TapeLine::Lidar,
        RawStream::Scanner => TapeLine::Scanner,
        RawStream::RearScanner => TapeLine::RearScanner,
        RawStream::Imu => TapeLine::Imu,
        RawStream::CanReceived => TapeLine::Can,
        RawStream::Operator => TapeLine::from_number(u16::from(*bytes.first()?))?,
        RawStream::MissionOrder => TapeLine::MissionOrder,
        RawStream::CanSent | RawStream::Route => return None,
    };
    Some((line, bytes))
}
