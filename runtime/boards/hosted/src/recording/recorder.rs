//! Writes a recording, message by message, so that a cut at any byte keeps every complete message before it.
//!
//! Messages stand in the data section without chunks: a chunk would be lost as a whole. The index at the end, which
//! viewers like and nobody needs, is written by [`Recorder::finish`].

use std::collections::BTreeMap;
use std::io::{Seek, Write};

use floorguard_core::time::Stamp;
use mcap::records::MessageHeader;

use super::schemas::Schema;

/// Raw bytes of a stream, as they came off the wire.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum RawStream {
    /// Lidar datagrams, port 2368.
    LidarData,
    /// Lidar position datagrams, port 8308.
    LidarPosition,
    /// Serial line of the safety scanner.
    Scanner,
    /// Serial line of the inertial unit.
    Imu,
    /// CAN frames towards the robot's computer: identifier (u32 little-endian, bit 31 = 29-bit), length, data.
    CanReceived,
    /// CAN frames from the robot's computer, in the same form.
    CanSent,
}

impl RawStream {
    /// All streams.
    pub const ALL: [Self; 6] =
        [Self::LidarData, Self::LidarPosition, Self::Scanner, Self::Imu, Self::CanReceived, Self::CanSent];

    /// The topic that holds it.
    #[must_use]
    pub const fn topic(self) -> &'static str {
        match self {
            Self::LidarData => "/raw/lidar",
            Self::LidarPosition => "/raw/lidar_position",
            Self::Scanner => "/raw/scanner",
            Self::Imu => "/raw/imu",
            Self::CanReceived => "/raw/can_received",
            Self::CanSent => "/raw/can_sent",
        }
    }
}

/// A recording could not be written.
#[derive(Debug, thiserror::Error)]
#[error("cannot write the recording: {0}; is the disk full?")]
pub struct RecordError(#[from] mcap::McapError);

/// A recording in the making.
pub struct Recorder<W: Write + Seek> {
    writer: mcap::Writer<W>,
    channels: BTreeMap<&'static str, (u16, u32)>,
}

impl<W: Write + Seek> Recorder<W> {
    /// Starts a recording.
    ///
    /// # Errors
    /// When the file cannot be written.
    pub fn new(sink: W) -> Result<Self, RecordError> {
        let options = mcap::WriteOptions::new()
            .profile("ros2")
            .library("floorguard")
            .use_chunks(false)
            .compression(None);
        Ok(Self { writer: options.create(sink)?, channels: BTreeMap::new() })
    }

    /// Writes one ROS 2 message.
    ///
    /// # Errors
    /// When the file cannot be written.
    pub fn message(
        &mut self,
        topic: &'static str,
        schema: &Schema,
        at: Stamp,
        data: &[u8],
    ) -> Result<(), RecordError> {
        if !self.channels.contains_key(topic) {
            let id = self.writer.add_schema(schema.name, "ros2msg", schema.definition().as_bytes())?;
            let channel = self.writer.add_channel(id, topic, "cdr", &BTreeMap::new())?;
            self.channels.insert(topic, (channel, 0));
        }
        self.write(topic, at, data)
    }

    /// Writes raw bytes of a stream with their time of arrival.
    ///
    /// # Errors
    /// When the file cannot be written.
    pub fn raw(&mut self, stream: RawStream, at: Stamp, data: &[u8]) -> Result<(), RecordError> {
        let topic = stream.topic();
        if !self.channels.contains_key(topic) {
            let channel = self.writer.add_channel(0, topic, "application/octet-stream", &BTreeMap::new())?;
            self.channels.insert(topic, (channel, 0));
        }
        self.write(topic, at, data)
    }

    fn write(&mut self, topic: &'static str, at: Stamp, data: &[u8]) -> Result<(), RecordError> {
        let Some((channel_id, sequence)) = self.channels.get_mut(topic) else { return Ok(()) };
        let time = at.as_micros().saturating_mul(1_000);
        let header = MessageHeader {
            channel_id: *channel_id,
            sequence: *sequence,
            log_time: time,
            publish_time: time,
        };
        *sequence = sequence.wrapping_add(1);
        Ok(self.writer.write_to_known_channel(&header, data)?)
    }

    /// Pushes everything written so far towards the disk.
    ///
    /// # Errors
    /// When the file cannot be written.
    pub fn flush(&mut self) -> Result<(), RecordError> {
        Ok(self.writer.flush()?)
    }

    /// Writes the index and closes the recording.
    ///
    /// # Errors
    /// When the file cannot be written.
    pub fn finish(mut self) -> Result<W, RecordError> {
        self.writer.finish()?;
        Ok(self.writer.into_inner())
    }
}
